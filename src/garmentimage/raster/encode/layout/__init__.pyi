from .node_order import (
    MAX_DEGREE as MAX_DEGREE,
    check_nodes as check_nodes,
    with_node_order as with_node_order,
)
from .samples import (
    trunk_share as trunk_share,
)
from .seam_graph import (
    SeamGraph as SeamGraph,
    build_seam_graph as build_seam_graph,
)
from .solve import (
    LAST_RESORT as LAST_RESORT,
    Layout as Layout,
    layouts as layouts,
)
