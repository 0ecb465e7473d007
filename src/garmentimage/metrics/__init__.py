"""How alike two patterns are, whether one can be sewn, and how well round trips go. No torch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
