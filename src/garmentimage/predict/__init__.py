"""Pictures to patterns: the cascade of the paper's Section 4.3 in use. Needs no torch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
