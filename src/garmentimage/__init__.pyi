__version__: str

from .body import (
    Body as Body,
    BodyMeasurements as BodyMeasurements,
    load_body as load_body,
    load_body_file as load_body_file,
    measurements as measurements,
)
from .draft import (
    draft_pattern as draft_pattern,
    kinds as kinds,
    sample as sample,
)
from .draft.templates import (
    Template as Template,
)
from .drape import (
    DrapedGarment as DrapedGarment,
    Fabric as Fabric,
    check_drape as check_drape,
    drape_pattern as drape_pattern,
    outfit as outfit,
)
from .drape.files import (
    load_drape as load_drape,
    save_drape as save_drape,
)
from .errors import (
    DatasetError as DatasetError,
    DecodeError as DecodeError,
    DraftError as DraftError,
    DrapeError as DrapeError,
    EncodeError as EncodeError,
    GarmentImageError as GarmentImageError,
    ImageError as ImageError,
    LearnError as LearnError,
    OutputError as OutputError,
    PatternError as PatternError,
    PatternFileError as PatternFileError,
    RenderError as RenderError,
    StitchError as StitchError,
)
from .latent import (
    LatentSpace as LatentSpace,
    generate as generate,
    interpolate as interpolate,
    nearest as nearest,
    transfer as transfer,
)
from .pattern import (
    Pattern as Pattern,
)
from .pattern.files import (
    load_pattern as load_pattern,
    save_pattern as save_pattern,
)
from .predict import (
    PatternPredictor as PatternPredictor,
)
from .raster import (
    BodyFrame as BodyFrame,
    EdgeType as EdgeType,
    GarmentImage as GarmentImage,
    load_image as load_image,
    save_image as save_image,
)
from .raster.decode import (
    decode as decode,
)
from .raster.encode import (
    encode as encode,
)
from .raster.repair import (
    repair as repair,
)
from .render import (
    save_png as save_png,
)
from .render.worn import (
    Look as Look,
    photograph as photograph,
)
