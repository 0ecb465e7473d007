from .card import (
    model_card as model_card,
)
from .settings import (
    TrainingSettings as TrainingSettings,
)
from .tasks import (
    Wanted as Wanted,
    lesson as lesson,
)
from .training import (
    MODEL as MODEL,
    RUN_FILE as RUN_FILE,
    train as train,
)
from .weights import (
    load_weights as load_weights,
)
