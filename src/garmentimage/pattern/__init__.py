"""Sewing patterns: panels, edges, stitches; reading, checking and writing them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
