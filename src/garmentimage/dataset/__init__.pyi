from .building import (
    BuildSettings as BuildSettings,
    FinishedShard as FinishedShard,
    build_dataset as build_dataset,
    plan_shards as plan_shards,
)
from .overview import (
    dataset_hash as dataset_hash,
    read_summary as read_summary,
    row_sheet as row_sheet,
)
from .read import (
    has_split as has_split,
    parse_patterns as parse_patterns,
    raster_arrays as raster_arrays,
    read_rows as read_rows,
    read_tables as read_tables,
    shard_files as shard_files,
    shard_metadata as shard_metadata,
)
from .recipe import (
    load_recipe as load_recipe,
    recipe_names as recipe_names,
)
from .row import (
    draft_garment as draft_garment,
    task_from_id as task_from_id,
)
from .stream import (
    RowStream as RowStream,
)
from .vocabulary import (
    all_phrases as all_phrases,
    aspect_of as aspect_of,
    bottoms_of as bottoms_of,
    random_prompt as random_prompt,
    synonyms as synonyms,
)
