"""The raster: GarmentImage, its files, encoding of patterns to it and decoding."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
