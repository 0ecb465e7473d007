from .template import (
    Template as Template,
)
