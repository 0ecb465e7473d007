from .attempts import (
    MAX_ATTEMPTS as MAX_ATTEMPTS,
    best_attempt as best_attempt,
)
from .editor import (
    DEFAULT_DENOISER as DEFAULT_DENOISER,
    DEFAULT_IMAGE_DECODER as DEFAULT_IMAGE_DECODER,
    DEFAULT_SPACE as DEFAULT_SPACE,
    DEFAULT_STEPS as DEFAULT_STEPS,
    REPROJECTIONS as REPROJECTIONS,
    TextEdit as TextEdit,
    TextEditor as TextEditor,
    check_options as check_options,
    check_pair as check_pair,
    denoiser_guidance as denoiser_guidance,
    denoiser_names as denoiser_names,
    image_decoder_names as image_decoder_names,
    normalised_text as normalised_text,
    run_edit as run_edit,
    stable_guidance as stable_guidance,
    strip_columns as strip_columns,
)
from .goal import (
    MIN_LENGTH_CHANGE_CM as MIN_LENGTH_CHANGE_CM,
    MIN_WIDTH_RATIO as MIN_WIDTH_RATIO,
)
from .guidance import (
    ScoreDistillation as ScoreDistillation,
)
from .source_prompt import (
    LONG_CM as LONG_CM,
    LONG_SLEEVE_CM as LONG_SLEEVE_CM,
    MIN_FAMILIARITY as MIN_FAMILIARITY,
    NARROW_CM as NARROW_CM,
    SHORT_CM as SHORT_CM,
    SHORT_SLEEVE_CM as SHORT_SLEEVE_CM,
    WIDE_CM as WIDE_CM,
    edit_prompts as edit_prompts,
)
from .vocabulary import (
    list_words as list_words,
    split_words as split_words,
)
