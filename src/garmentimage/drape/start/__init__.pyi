from .folding import (
    ROLL as ROLL,
    fold_onto as fold_onto,
    from_seams as from_seams,
    lay_onto as lay_onto,
    lie_over as lie_over,
    stand_up as stand_up,
)
from .placement import (
    EASE as EASE,
    ELASTIC as ELASTIC,
    TIGHT as TIGHT,
    Placement as Placement,
    on_hips as on_hips,
    place_on_body as place_on_body,
)
from .pleats import (
    pressed_pleats as pressed_pleats,
)
from .starting import (
    start_points as start_points,
)
from .tuck import (
    tuck_in as tuck_in,
)
