"""From a sewing pattern to a GarmentImage (paper, Section 3.2)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
