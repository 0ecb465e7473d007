from .comparison import (
    RoundtripResult as RoundtripResult,
    compare_patterns as compare_patterns,
)
from .likely import (
    surely_same as surely_same,
)
from .matching import (
    Matching as Matching,
    PanelPair as PanelPair,
    aligned_points as aligned_points,
    boundary_distance as boundary_distance,
    boundary_gap as boundary_gap,
    iou_matrix as iou_matrix,
    loop_polygon as loop_polygon,
    match_panels as match_panels,
    matching_from as matching_from,
    panel_iou as panel_iou,
)
from .on_cloth import (
    differences_on_cloth as differences_on_cloth,
)
from .pairing import (
    pair_garments as pair_garments,
)
from .stitch_graphs import (
    GraphMatch as GraphMatch,
    SeamSide as SeamSide,
    StitchGraph as StitchGraph,
    lengths_agree as lengths_agree,
    match_graphs as match_graphs,
    same_stitch_graph as same_stitch_graph,
    seam_agreement as seam_agreement,
    stitch_graph as stitch_graph,
)
from .topology import (
    topology_hash as topology_hash,
)
from .validation import (
    drawing_faults as drawing_faults,
    pattern_faults as pattern_faults,
    ratio_faults as ratio_faults,
    stitch_faults as stitch_faults,
    structure_faults as structure_faults,
)
