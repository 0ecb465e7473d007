from .placement import (
    facing_inwards as facing_inwards,
    unknown_place as unknown_place,
)
from .sewable import (
    ARC_TOL as ARC_TOL,
    GRAIN_TOL as GRAIN_TOL,
    MAX_COORDINATE as MAX_COORDINATE,
    MAX_EDGES as MAX_EDGES,
    MAX_PANEL_SIZE as MAX_PANEL_SIZE,
    MAX_PANELS as MAX_PANELS,
    MAX_STITCHES as MAX_STITCHES,
    MIN_EDGE_LENGTH as MIN_EDGE_LENGTH,
    check_ends as check_ends,
    check_name as check_name,
    check_pattern as check_pattern,
    check_side as check_side,
    check_structure as check_structure,
    components as components,
    edge_place as edge_place,
    panel_place as panel_place,
)
from .symmetry import (
    off_centre as off_centre,
    symmetry_plane as symmetry_plane,
)
