from .card import (
    model_card as model_card,
)
from .tasks import (
    Wanted as Wanted,
    lesson as lesson,
)
from .training import (
    MODEL as MODEL,
    RUN_FILE as RUN_FILE,
    Settings as Settings,
    train as train,
)
from .weights import (
    load_weights as load_weights,
)
