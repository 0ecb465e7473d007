from .decoded import (
    Latent as Latent,
    Step as Step,
    step_of as step_of,
    topology_of as topology_of,
)
from .pictures import (
    ONE_COLOUR as ONE_COLOUR,
    WARNING as WARNING,
    WORN_PIXELS as WORN_PIXELS,
    Shown as Shown,
    beside as beside,
    film as film,
    shown as shown,
    strip as strip,
)
from .runtime import (
    CONFIG as CONFIG,
    SHIPPED as SHIPPED,
    damaged as damaged,
    network_folder as network_folder,
    open_session as open_session,
    read_config as read_config,
    run_session as run_session,
    shipped_names as shipped_names,
)
