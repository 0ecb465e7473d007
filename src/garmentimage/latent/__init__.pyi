from .operations import (
    STRENGTHS as STRENGTHS,
    edit as edit,
    generate as generate,
    interpolate as interpolate,
    nearest as nearest,
    transfer as transfer,
)
from .space import (
    DECODER as DECODER,
    ENCODER as ENCODER,
    GARMENTS as GARMENTS,
    LatentSpace as LatentSpace,
    space_names as space_names,
)
