"""Cloth on a body: panel meshes sewn together, put round the body, and simulated until at rest."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
