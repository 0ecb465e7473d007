from .bending import (
    bending_matrix as bending_matrix,
)
from .meshing import (
    VERTICES as VERTICES,
    check_size as check_size,
    mesh as mesh,
    missed as missed,
)
from .normals import (
    vertex_normals as vertex_normals,
)
from .rest import (
    Rest as Rest,
    most_strain as most_strain,
    rest_of as rest_of,
    strain as strain,
)
