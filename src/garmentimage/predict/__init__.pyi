from .photo import (
    Box as Box,
    find_wearer as find_wearer,
)
from .predictor import (
    DEFAULT_NETWORK as DEFAULT_NETWORK,
    PICTURES_FILE as PICTURES_FILE,
    PREDICTOR_FILE as PREDICTOR_FILE,
    PatternPredictor as PatternPredictor,
    Prediction as Prediction,
    certainty as certainty,
    plane_distance as plane_distance,
    thumbnail as thumbnail,
)
from .report_image import (
    draw_report as draw_report,
)
