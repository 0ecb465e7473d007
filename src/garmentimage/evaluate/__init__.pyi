from .amounts import (
    ImageAmounts as ImageAmounts,
    LatentAmounts as LatentAmounts,
)
from .edit_triplets import (
    EDITS as EDITS,
)
from .figure import (
    edit_picture as edit_picture,
    interpolation_picture as interpolation_picture,
    predictions_picture as predictions_picture,
    text_edits_picture as text_edits_picture,
)
from .image import (
    SPLIT_NAMES as SPLIT_NAMES,
    evaluate_images as evaluate_images,
    has_unseen as has_unseen,
    load_garments as load_garments,
    measuring_order as measuring_order,
    with_baselines as with_baselines,
)
from .latent import (
    INTERPOLATION_STEPS as INTERPOLATION_STEPS,
    Candidate as Candidate,
    describe_run as describe_run,
    draw_pairs as draw_pairs,
    draw_triplets as draw_triplets,
    evaluate_latent as evaluate_latent,
    load_codec as load_codec,
)
from .predictors import (
    TEACHER_STAGES as TEACHER_STAGES,
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
