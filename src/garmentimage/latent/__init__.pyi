from .operations import (
    STRENGTHS as STRENGTHS,
    edit as edit,
    generate as generate,
    interpolate as interpolate,
    nearest as nearest,
    transfer as transfer,
)
from .space import (
    DECODER_FILE as DECODER_FILE,
    ENCODER_FILE as ENCODER_FILE,
    GARMENTS_FILE as GARMENTS_FILE,
    LatentSpace as LatentSpace,
    space_names as space_names,
)
