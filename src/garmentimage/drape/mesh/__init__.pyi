from .bending import (
    bending_matrix as bending_matrix,
)
from .meshing import (
    DEFAULT_VERTICES as DEFAULT_VERTICES,
    check_size as check_size,
    explain_vertex_count as explain_vertex_count,
    mesh as mesh,
)
from .normals import (
    sums_by as sums_by,
    vertex_normals as vertex_normals,
)
from .rest import (
    Pressed as Pressed,
    Rest as Rest,
    peak_strain as peak_strain,
    rest_of as rest_of,
    strain as strain,
)
