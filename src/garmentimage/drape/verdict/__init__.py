"""Whether a buyer would accept a drape: skin that shows, cloth through cloth, what slid."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
