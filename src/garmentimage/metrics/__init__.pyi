from .intervals import (
    Interval as Interval,
    interval as interval,
)
from .preserved import (
    EditedRegion as EditedRegion,
    preserved_iou as preserved_iou,
)
from .published import (
    MIN_EDGES as MIN_EDGES,
    PADDING_ATOL as PADDING_ATOL,
    Slots as Slots,
    published_figures as published_figures,
    quaternion as quaternion,
    slots_of as slots_of,
    tag_stitches as tag_stitches,
    universal_translation as universal_translation,
)
from .report import (
    report_to_json as report_to_json,
)
from .roundtrip import (
    FileReport as FileReport,
    KindSummary as KindSummary,
    RoundTrip as RoundTrip,
    garment_kind as garment_kind,
    roundtrip_file as roundtrip_file,
    roundtrip_many as roundtrip_many,
    summarise as summarise,
    summary_table as summary_table,
)
from .shape_attributes import (
    ShapeAttributes as ShapeAttributes,
    measure_shape as measure_shape,
)
from .similarity import (
    Likeness as Likeness,
    Scores as Scores,
    likeness as likeness,
    likeness_summary as likeness_summary,
)
from .tables import (
    markdown_table as markdown_table,
    plain_table as plain_table,
)
