from .placement import (
    EASE as EASE,
    ELASTIC as ELASTIC,
    TIGHT as TIGHT,
    Standing as Standing,
    on_hips as on_hips,
    standing as standing,
)
from .starting import (
    start_points as start_points,
)
from .tuck import (
    tucked_in as tucked_in,
)
