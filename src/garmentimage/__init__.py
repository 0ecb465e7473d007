"""garmentimage: sewing patterns as rasters that neural networks understand, and back.

    import garmentimage as gi

    pattern = gi.load_pattern("dress.json")
    image = gi.encode(pattern, grid=16)
    channels = image.to_channels()  # float32 [34, 16, 16]
    again = gi.decode(image)
    gi.save_pattern(again, "dress-again.json")
    worn = gi.drape_pattern(pattern)  # on a body, at rest
    gi.save_png("dress.png", gi.photograph(worn, size=512).colour)

Names are loaded on first use, so importing the package is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from garmentimage.errors import (
    DatasetError,
    DecodeError,
    DraftError,
    DrapeError,
    EncodeError,
    GarmentImageError,
    ImageError,
    LearnError,
    OutputError,
    PatternError,
    PatternFileError,
    RenderError,
    StitchError,
)

if TYPE_CHECKING:
    from garmentimage.body.body import Body, load_body
    from garmentimage.body.measurements import BodyMeasurements, measurements
    from garmentimage.body.obj import load_body_file
    from garmentimage.draft.kinds import draft as draft_pattern
    from garmentimage.draft.kinds import kinds
    from garmentimage.draft.sample import sample
    from garmentimage.draft.template import Template
    from garmentimage.drape.export import save_worn
    from garmentimage.drape.fabric import Fabric
    from garmentimage.drape.glb import load_worn
    from garmentimage.drape.outfit import outfit
    from garmentimage.drape.wear import check_worn
    from garmentimage.drape.wear import drape as drape_pattern
    from garmentimage.drape.worn import Worn
    from garmentimage.explore.space import LatentSpace
    from garmentimage.explore.walk import generate, interpolate, nearest, transfer
    from garmentimage.pattern.model import Pattern
    from garmentimage.pattern.spec import load_pattern, save_pattern
    from garmentimage.predict.network import PatternPredictor
    from garmentimage.raster.decode import decode
    from garmentimage.raster.encode import encode
    from garmentimage.raster.files import load_image, save_image
    from garmentimage.raster.frame import BodyFrame
    from garmentimage.raster.image import EdgeType, GarmentImage
    from garmentimage.raster.repair import repair
    from garmentimage.render.look import Look, photograph
    from garmentimage.render.png import save_png

__version__ = "0.1.0"

_WHERE = {
    "BodyMeasurements": "garmentimage.body.measurements",
    "measurements": "garmentimage.body.measurements",
    "draft_pattern": "garmentimage.draft.kinds:draft",
    "kinds": "garmentimage.draft.kinds",
    "sample": "garmentimage.draft.sample",
    "Template": "garmentimage.draft.template",
    "Pattern": "garmentimage.pattern.model",
    "load_pattern": "garmentimage.pattern.spec",
    "save_pattern": "garmentimage.pattern.spec",
    "BodyFrame": "garmentimage.raster.frame",
    "GarmentImage": "garmentimage.raster.image",
    "EdgeType": "garmentimage.raster.image",
    "load_image": "garmentimage.raster.files",
    "save_image": "garmentimage.raster.files",
    "encode": "garmentimage.raster.encode",
    "decode": "garmentimage.raster.decode",
    "repair": "garmentimage.raster.repair",
    "Body": "garmentimage.body.body",
    "load_body": "garmentimage.body.body",
    "load_body_file": "garmentimage.body.obj",
    "Worn": "garmentimage.drape.worn",
    "drape_pattern": "garmentimage.drape.wear:drape",
    "check_worn": "garmentimage.drape.wear",
    "Fabric": "garmentimage.drape.fabric",
    "outfit": "garmentimage.drape.outfit",
    "save_worn": "garmentimage.drape.export",
    "load_worn": "garmentimage.drape.glb",
    "LatentSpace": "garmentimage.explore.space",
    "interpolate": "garmentimage.explore.walk",
    "transfer": "garmentimage.explore.walk",
    "generate": "garmentimage.explore.walk",
    "nearest": "garmentimage.explore.walk",
    "PatternPredictor": "garmentimage.predict.network",
    "Look": "garmentimage.render.look",
    "photograph": "garmentimage.render.look",
    "save_png": "garmentimage.render.png",
}

__all__ = [
    "Body",
    "BodyFrame",
    "BodyMeasurements",
    "DatasetError",
    "DecodeError",
    "DraftError",
    "DrapeError",
    "EdgeType",
    "EncodeError",
    "Fabric",
    "GarmentImage",
    "GarmentImageError",
    "ImageError",
    "LatentSpace",
    "LearnError",
    "Look",
    "OutputError",
    "Pattern",
    "PatternError",
    "PatternFileError",
    "PatternPredictor",
    "RenderError",
    "StitchError",
    "Template",
    "Worn",
    "check_worn",
    "decode",
    "draft_pattern",
    "drape_pattern",
    "encode",
    "generate",
    "interpolate",
    "kinds",
    "load_body",
    "load_body_file",
    "load_image",
    "load_pattern",
    "load_worn",
    "measurements",
    "nearest",
    "outfit",
    "photograph",
    "repair",
    "sample",
    "save_image",
    "save_pattern",
    "save_png",
    "save_worn",
    "transfer",
]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        module, _, other_name = _WHERE[name].partition(":")
        return getattr(import_module(module), other_name or name)
    raise AttributeError(f"module 'garmentimage' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
