from .kind import (
    KINDS as KINDS,
    Kind as Kind,
    draft_pattern as draft_pattern,
    find_kind as find_kind,
    kinds as kinds,
)
from .parameters import (
    Parameter as Parameter,
    Value as Value,
    checked_values as checked_values,
)
from .sampling import (
    Sample as Sample,
    Source as Source,
    drafted as drafted,
    sample as sample,
)
