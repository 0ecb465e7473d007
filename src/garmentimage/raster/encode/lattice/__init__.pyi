from .attempts import (
    drawings as drawings,
    trials as trials,
)
from .drawing import (
    Path as Path,
)
from .route import (
    CrossingError as CrossingError,
)
from .shapes import (
    lost_shape as lost_shape,
)
