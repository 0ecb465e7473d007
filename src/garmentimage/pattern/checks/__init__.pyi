from .placement import (
    facing_inwards as facing_inwards,
    unknown_place as unknown_place,
)
from .sewable import (
    ARC_TOL as ARC_TOL,
    COORDINATE_LIMIT as COORDINATE_LIMIT,
    EDGE_LIMIT as EDGE_LIMIT,
    GRAIN_TOL as GRAIN_TOL,
    PANEL_LIMIT as PANEL_LIMIT,
    PANEL_SIZE_LIMIT as PANEL_SIZE_LIMIT,
    SHORTEST_EDGE as SHORTEST_EDGE,
    STITCH_LIMIT as STITCH_LIMIT,
    check_name as check_name,
    check_pattern as check_pattern,
    check_structure as check_structure,
    components as components,
    edge_place as edge_place,
    panel_place as panel_place,
)
