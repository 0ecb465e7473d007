from .amounts import (
    ImageAmounts as ImageAmounts,
    LatentAmounts as LatentAmounts,
)
from .edit_triplets import (
    EDITS as EDITS,
)
from .figure import (
    draw_latent_figures as draw_latent_figures,
    draw_prediction_figures as draw_prediction_figures,
    draw_text_edits as draw_text_edits,
)
from .image import (
    evaluate_images as evaluate_images,
    with_baselines as with_baselines,
)
from .latent import (
    Candidate as Candidate,
    evaluate_latent as evaluate_latent,
)
from .predictors import (
    Predictor as Predictor,
    predictors_from_names as predictors_from_names,
)
from .splits import (
    group_by_held_out as group_by_held_out,
    read_run as read_run,
)
from .table import (
    held_out_table as held_out_table,
    image_table as image_table,
    latent_table as latent_table,
    text_edits_table as text_edits_table,
)
from .text import (
    EditMethod as EditMethod,
    evaluate_text_edits as evaluate_text_edits,
)
