from .attempts import (
    drawings as drawings,
    trials as trials,
)
from .drawing import (
    Path as Path,
)
from .node_order import (
    check_nodes as check_nodes,
)
from .shapes import (
    lost_shape as lost_shape,
)
