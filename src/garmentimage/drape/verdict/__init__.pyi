from .judging import (
    assess_drape as assess_drape,
)
