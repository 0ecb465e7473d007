from .samples import (
    trunk_share as trunk_share,
)
from .seam_graph import (
    SeamComplex as SeamComplex,
    seam_complex as seam_complex,
)
from .solve import (
    Layout as Layout,
    layouts as layouts,
)
