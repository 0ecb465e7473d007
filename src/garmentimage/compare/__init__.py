"""Two patterns compared: panels, stitch graphs, faults; whether one is the same as the other."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
