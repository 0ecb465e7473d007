"""A picture in, a pattern out: the cascade of Section 4.3 in use. No torch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
