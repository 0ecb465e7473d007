from .distance_field import (
    DistanceField as DistanceField,
    body_field as body_field,
    cloth_field as cloth_field,
)
from .solver import (
    Attachment as Attachment,
    Motion as Motion,
    SolverSettings as SolverSettings,
    Watch as Watch,
    solve as solve,
)
