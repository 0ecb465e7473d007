from .best_of import (
    MOST_TRIES as MOST_TRIES,
    best_try as best_try,
)
from .editor import (
    DENOISER as DENOISER,
    PICTURES as PICTURES,
    SETTLE as SETTLE,
    SPACE as SPACE,
    STEPS_USUAL as STEPS_USUAL,
    TextEdit as TextEdit,
    TextEditor as TextEditor,
    check_amounts as check_amounts,
    check_pair as check_pair,
    checked_text as checked_text,
    denoiser_guidance as denoiser_guidance,
    denoiser_names as denoiser_names,
    moved as moved,
    picture_names as picture_names,
    stable_guidance as stable_guidance,
)
from .goal import (
    LONGER_CM as LONGER_CM,
    WIDER as WIDER,
)
from .guidance import (
    ScoreDistillation as ScoreDistillation,
)
from .source_prompt import (
    FAMILIAR as FAMILIAR,
    LONG_CM as LONG_CM,
    LONG_SLEEVE_CM as LONG_SLEEVE_CM,
    NARROW_CM as NARROW_CM,
    SHORT_CM as SHORT_CM,
    SHORT_SLEEVE_CM as SHORT_SLEEVE_CM,
    WIDE_CM as WIDE_CM,
    contrast as contrast,
)
from .strip import (
    way as way,
    way_picture as way_picture,
)
from .vocabulary import (
    named as named,
    words_of as words_of,
)
