"""How alike two patterns are, whether one can be sewn, and how well round trips go. No torch."""

from garmentimage.compare.judge import RoundtripResult, judge
from garmentimage.compare.matching import (
    Matching,
    PanelPair,
    boundary_distance,
    boundary_gap,
    iou_matrix,
    match_panels,
    matching_from,
    panel_iou,
)
from garmentimage.compare.stitch_graph import (
    GraphMatch,
    SeamSide,
    StitchGraph,
    lengths_agree,
    match_graphs,
    same_stitch_graph,
    seam_agreement,
    stitch_graph,
)
from garmentimage.compare.validity import validity
from garmentimage.metrics.intervals import Interval, interval
from garmentimage.metrics.likeness import Likeness, Scores, likeness, likeness_summary
from garmentimage.metrics.published import (
    Slots,
    published_figures,
    slots_of,
    tag_stitches,
)
from garmentimage.metrics.report import report_to_json
from garmentimage.metrics.roundtrip import (
    FileReport,
    KindSummary,
    Trip,
    kind_of,
    roundtrip_file,
    roundtrip_many,
    summarise,
    summary_table,
)

__all__ = [
    "FileReport",
    "GraphMatch",
    "Interval",
    "KindSummary",
    "Likeness",
    "Matching",
    "PanelPair",
    "RoundtripResult",
    "Scores",
    "SeamSide",
    "Slots",
    "StitchGraph",
    "Trip",
    "boundary_distance",
    "boundary_gap",
    "interval",
    "iou_matrix",
    "judge",
    "kind_of",
    "lengths_agree",
    "likeness",
    "likeness_summary",
    "match_graphs",
    "match_panels",
    "matching_from",
    "panel_iou",
    "published_figures",
    "report_to_json",
    "roundtrip_file",
    "roundtrip_many",
    "same_stitch_graph",
    "seam_agreement",
    "slots_of",
    "stitch_graph",
    "summarise",
    "summary_table",
    "tag_stitches",
    "validity",
]
