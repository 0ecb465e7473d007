from .decoder import (
    decode as decode,
)
from .divisions import (
    divisions_on as divisions_on,
    shares_along as shares_along,
)
