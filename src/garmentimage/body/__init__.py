"""Bodies that garments are drafted for and put on: meshes, and the measurements taken off them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
