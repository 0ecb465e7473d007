from .photo import (
    Box as Box,
    find_wearer as find_wearer,
)
from .predictor import (
    DEFAULT as DEFAULT,
    PICTURES as PICTURES,
    PREDICTOR as PREDICTOR,
    PatternPredictor as PatternPredictor,
    Prediction as Prediction,
    certainty as certainty,
    distance_from as distance_from,
    shrunk as shrunk,
)
from .report_image import (
    sheet as sheet,
)
