from .amounts import (
    ImageAmounts as ImageAmounts,
    LatentAmounts as LatentAmounts,
)
from .edit_triplets import (
    EDITS as EDITS,
)
from .figure import (
    edit_picture as edit_picture,
    guesses_picture as guesses_picture,
    text_picture as text_picture,
    way_picture as way_picture,
)
from .image import (
    CALLED as CALLED,
    evaluate_images as evaluate_images,
    garments as garments,
    has_unseen as has_unseen,
    order_of as order_of,
    with_parts as with_parts,
)
from .latent import (
    STEPS as STEPS,
    Judged as Judged,
    codec_of as codec_of,
    evaluate_latent as evaluate_latent,
    facts as facts,
    pairs_of as pairs_of,
    triplets_of as triplets_of,
)
from .predictors import (
    GIVEN as GIVEN,
    Guesser as Guesser,
    named as named,
)
from .splits import (
    groups as groups,
    run_of as run_of,
)
from .table import (
    held_out_table as held_out_table,
    image_table as image_table,
    markdown as markdown,
    text_table as text_table,
)
from .text import (
    Editing as Editing,
    evaluate_text_edits as evaluate_text_edits,
)
