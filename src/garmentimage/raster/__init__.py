"""The raster: GarmentImage, its files, and the way from a pattern to it and back."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
