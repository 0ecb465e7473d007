"""The garment laid out in the picture plane, continuous still, before it meets the grid."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
