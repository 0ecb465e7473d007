from .channels import (
    CHANNEL_CONTRACT as CHANNEL_CONTRACT,
    CHANNELS_PER_LAYER as CHANNELS_PER_LAYER,
    CONTRACT_2 as CONTRACT_2,
    CONTRACTS as CONTRACTS,
    EDGE_TYPE_COUNT as EDGE_TYPE_COUNT,
    MAX_LAYERS as MAX_LAYERS,
    PLAIN_LAYOUT as PLAIN_LAYOUT,
    ChannelLayout as ChannelLayout,
    Contract as Contract,
    join_channels as join_channels,
    layout_of as layout_of,
    split_channels as split_channels,
    with_contract as with_contract,
)
from .files import (
    image_bytes as image_bytes,
    load_channels as load_channels,
    load_image as load_image,
    save_image as save_image,
)
from .frame import (
    BodyFrame as BodyFrame,
)
from .image import (
    BOTTOM as BOTTOM,
    LEFT as LEFT,
    EdgeType as EdgeType,
    GarmentImage as GarmentImage,
    PanelMark as PanelMark,
    mirrored_channels as mirrored_channels,
)
