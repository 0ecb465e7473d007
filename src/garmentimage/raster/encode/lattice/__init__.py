"""The garment as a drawing on the lattice of the grid: routed, compacted, polished."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
