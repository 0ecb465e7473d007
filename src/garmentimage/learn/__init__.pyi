from .card import (
    model_card as model_card,
)
from .run_folder import (
    MODEL_FOLDER as MODEL_FOLDER,
    RUN_FILE as RUN_FILE,
)
from .settings import (
    TrainingSettings as TrainingSettings,
)
from .tasks import (
    TaskOptions as TaskOptions,
    TrainingTask as TrainingTask,
    task_for as task_for,
)
from .training import (
    TrainingResult as TrainingResult,
    train as train,
)
from .weights import (
    load_weights as load_weights,
)
