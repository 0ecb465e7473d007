from .direction import (
    turned_round as turned_round,
)
from .dissolve import (
    without_stubs as without_stubs,
)
from .finding import (
    Finding as Finding,
)
from .model import (
    Circle as Circle,
    Cubic as Cubic,
    Curvature as Curvature,
    Edge as Edge,
    Loop as Loop,
    Notch as Notch,
    Panel as Panel,
    Pattern as Pattern,
    Pleat as Pleat,
    PleatFold as PleatFold,
    Point as Point,
    Quadratic as Quadratic,
    SewnOnto as SewnOnto,
    Side as Side,
    Stitch as Stitch,
    Vector as Vector,
    chord_count as chord_count,
    euler_angles as euler_angles,
    loop_from_curves as loop_from_curves,
    mirrored_curvature as mirrored_curvature,
    polygon_of as polygon_of,
)
from .placement import (
    FRONTAL as FRONTAL,
    floor_shift as floor_shift,
)
from .pleats import (
    Crease as Crease,
    PleatFoldLine as PleatFoldLine,
    creases as creases,
    fold_lines as fold_lines,
    is_on_cloth as is_on_cloth,
    pleat_of as pleat_of,
)
from .seam_runs import (
    STUB_CM as STUB_CM,
    SeamRun as SeamRun,
    sewn_runs as sewn_runs,
    side_loops as side_loops,
    stubs as stubs,
)
from .tubes import (
    TUBE_SHARE as TUBE_SHARE,
    tube_sides as tube_sides,
)
from .turned import (
    LaidOpen as LaidOpen,
    fold_over as fold_over,
    fold_seams as fold_seams,
    lay_open as lay_open,
    turned_panels as turned_panels,
)
