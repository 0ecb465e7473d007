from .images import (
    PICTURE_COLUMN as PICTURE_COLUMN,
    ImagedGarments as ImagedGarments,
    ImageSplit as ImageSplit,
    load_split as load_split,
    read_pixels as read_pixels,
)
from .latent_images import (
    CaptionedImages as CaptionedImages,
    LatentImages as LatentImages,
    load_captioned as load_captioned,
    split_encoder as split_encoder,
)
from .pattern_vectors import (
    VERTEX_SIZE as VERTEX_SIZE,
    VOCABULARY_FILE as VOCABULARY_FILE,
    PatternVectors as PatternVectors,
    build_vocabulary as build_vocabulary,
    read_patterns as read_patterns,
    read_vocabulary as read_vocabulary,
    to_vectors as to_vectors,
)
from .rasters import (
    LAYERS as LAYERS,
    VECTOR_CM as VECTOR_CM,
    LabelledRasters as LabelledRasters,
    Rasters as Rasters,
    mirrored_flags as mirrored_flags,
    mirrored_types as mirrored_types,
    mirrored_vectors as mirrored_vectors,
    read_rasters as read_rasters,
    rest_vectors as rest_vectors,
)
from .rows import (
    TensorRows as TensorRows,
)
from .slot_outputs import (
    SlotOutputs as SlotOutputs,
    pattern_from as pattern_from,
)
from .slot_vectors import (
    EDGE_SIZE as EDGE_SIZE,
    PLACEMENT_SIZE as PLACEMENT_SIZE,
    ROW as ROW,
    TAGS as TAGS,
    ImagedSlots as ImagedSlots,
    SlotConfig as SlotConfig,
    SlotVectors as SlotVectors,
    slot_vocabulary as slot_vocabulary,
    to_slots as to_slots,
)
from .text_encoder import (
    TEXT_SIZE as TEXT_SIZE,
    embed_texts as embed_texts,
)
from .waist_mix import (
    mix_at_waist as mix_at_waist,
    recolour_cloth as recolour_cloth,
)
