from .cascade import (
    ABLATIONS as ABLATIONS,
    PAPER_CONFIG as PAPER_CONFIG,
    Cascade as Cascade,
    CascadeConfig as CascadeConfig,
    Stage as Stage,
)
from .denoiser import (
    Denoiser as Denoiser,
    DenoiserConfig as DenoiserConfig,
    alpha_sigma as alpha_sigma,
)
from .garment_vae import (
    GarmentVAE as GarmentVAE,
    network_inputs as network_inputs,
    output_channels as output_channels,
    vae_config as vae_config,
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
