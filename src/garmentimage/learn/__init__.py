"""Networks on GarmentImages and on vectors, and their training. Needs torch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
