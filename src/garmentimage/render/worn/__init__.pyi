from .background import (
    plain as plain,
    scenery as scenery,
)
from .camera import (
    VIEWS as VIEWS,
)
from .look import (
    Look as Look,
    photograph as photograph,
)
from .maps import (
    map_bytes as map_bytes,
)
from .photographing import (
    SIZE_LIMITS as SIZE_LIMITS,
    body_camera as body_camera,
)
from .prints import (
    Print as Print,
    checks as checks,
    dots as dots,
    picture_print as picture_print,
    stripes as stripes,
)
from .surface import (
    PAPER_COLOURS as PAPER_COLOURS,
    panel_groups as panel_groups,
)
from .tint import (
    Tint as Tint,
    rgb as rgb,
)
