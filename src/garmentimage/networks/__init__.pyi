from .decoded import (
    DecodedGarment as DecodedGarment,
    Latent as Latent,
    decoded_garment as decoded_garment,
    topology_or_empty as topology_or_empty,
)
from .pictures import (
    ONE_COLOUR as ONE_COLOUR,
    WARNING_COLOUR as WARNING_COLOUR,
    WORN_PIXELS as WORN_PIXELS,
    StripFrame as StripFrame,
    animation as animation,
    draped_frame as draped_frame,
    figure_pixels as figure_pixels,
    side_by_side as side_by_side,
    strip as strip,
)
from .runtime import (
    CONFIG_FILE as CONFIG_FILE,
    LATENT_CONTRACTS as LATENT_CONTRACTS,
    WEIGHTS_FOLDER as WEIGHTS_FOLDER,
    OnnxNetwork as OnnxNetwork,
    bundled_names as bundled_names,
    channel_layout as channel_layout,
    check_contract as check_contract,
    damaged_file as damaged_file,
    network_folder as network_folder,
    read_arrays as read_arrays,
    read_config as read_config,
)
