"""Panels as triangles, sewn together, and what a solver needs to know of them at rest."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
