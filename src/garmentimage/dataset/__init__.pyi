from .building import (
    Build as Build,
    Done as Done,
    build as build,
    plan as plan,
)
from .overview import (
    dataset_hash as dataset_hash,
    row_sheet as row_sheet,
    summary_of as summary_of,
)
from .read import (
    facts as facts,
    has_split as has_split,
    patterns_of as patterns_of,
    rasters as rasters,
    shard_files as shard_files,
    tables as tables,
)
from .recipe import (
    load_recipe as load_recipe,
    recipe_names as recipe_names,
)
from .row import (
    draw as draw,
    task_of as task_of,
)
from .wording import (
    alike as alike,
    aspect_of as aspect_of,
    bottoms_of as bottoms_of,
    every_phrase as every_phrase,
    worded as worded,
)
