from .repairer import (
    LEVELS as LEVELS,
    RepairLevel as RepairLevel,
    RepairReport as RepairReport,
    repair as repair,
)
from .walls import (
    without_flaps as without_flaps,
)
