"""Faults of a drape: skin that shows, limbs beside their openings, cloth that slid or is tight."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
