from .cascade import (
    DEPARTURES as DEPARTURES,
    PAPER as PAPER,
    Cascade as Cascade,
    CascadeConfig as CascadeConfig,
)
from .denoiser import (
    Denoiser as Denoiser,
    DenoiserConfig as DenoiserConfig,
    shares as shares,
)
from .garment_vae import (
    GarmentVAE as GarmentVAE,
    default_config as default_config,
    from_channels as from_channels,
    to_channels as to_channels,
)
from .image_decoder import (
    ImageDecoder as ImageDecoder,
    ImageDecoderConfig as ImageDecoderConfig,
)
from .image_encoder import (
    read_resnet as read_resnet,
)
from .slot_networks import (
    SLOT_NETWORKS as SLOT_NETWORKS,
)
from .vector_vae import (
    VectorVAE as VectorVAE,
    VectorVAEConfig as VectorVAEConfig,
)
