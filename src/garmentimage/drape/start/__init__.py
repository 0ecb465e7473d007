"""Where cloth begins: panels round the body, sleeves along the arms, trousers along the legs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
