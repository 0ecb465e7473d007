from .images import (
    PICTURE as PICTURE,
    Album as Album,
    Pictured as Pictured,
    pixels as pixels,
    read_album as read_album,
)
from .latent_images import (
    Captioned as Captioned,
    Worn as Worn,
    latents_of as latents_of,
    read_captioned as read_captioned,
    worn as worn,
)
from .pattern_vectors import (
    NUMBERS as NUMBERS,
    WORDS as WORDS,
    Vectors as Vectors,
    read_patterns as read_patterns,
    read_vocabulary as read_vocabulary,
    vectors as vectors,
    vocabulary as vocabulary,
)
from .rasters import (
    INPUTS as INPUTS,
    LAYERS as LAYERS,
    VECTOR_CM as VECTOR_CM,
    Labelled as Labelled,
    Rasters as Rasters,
    mirrored_flags as mirrored_flags,
    mirrored_types as mirrored_types,
    mirrored_vectors as mirrored_vectors,
    read_rasters as read_rasters,
    rest_vectors as rest_vectors,
)
from .slot_vectors import (
    NUMBERS_A_PLACE as NUMBERS_A_PLACE,
    NUMBERS_AN_EDGE as NUMBERS_AN_EDGE,
    PicturedSlots as PicturedSlots,
    SlotConfig as SlotConfig,
    SlotOutputs as SlotOutputs,
    Usual as Usual,
    asked_losses as asked_losses,
    in_slots as in_slots,
    pattern_from as pattern_from,
    pictured_slots as pictured_slots,
    quiet as quiet,
    slot_losses as slot_losses,
    slot_words as slot_words,
)
from .text_encoder import (
    SIZE as SIZE,
    embedded as embedded,
)
from .waist_mix import (
    recombined as recombined,
    repainted as repainted,
)
