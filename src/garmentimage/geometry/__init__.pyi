from ._kernels_heap import (
    heap_pop as heap_pop,
    heap_push as heap_push,
)
from ._kernels_union_find import (
    find_root as find_root,
    union as union,
)
from .components import (
    component_labels as component_labels,
    connected_components as connected_components,
)
from .crossings import (
    contains as contains,
    touching_sides as touching_sides,
)
from .curves import (
    CHORDS as CHORDS,
    Arc as Arc,
    Bezier as Bezier,
    Curve as Curve,
    Line as Line,
    Point as Point,
    to_point as to_point,
)
from .polygons import (
    centroid as centroid,
    lengths_along as lengths_along,
    polyline_length as polyline_length,
    resample as resample,
    signed_area as signed_area,
)
