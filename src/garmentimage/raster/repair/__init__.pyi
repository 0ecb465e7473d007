from .repairer import (
    LEVELS as LEVELS,
    RepairLevel as RepairLevel,
    RepairReport as RepairReport,
    repair as repair,
)
from .walls import (
    remove_dangling_cuts as remove_dangling_cuts,
)
