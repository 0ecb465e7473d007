from .parameter import (
    as_json as as_json,
)
from .template import (
    Template as Template,
)
