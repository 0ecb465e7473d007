"""garmentimage: sewing patterns as rasters that neural networks understand, and back.

    import garmentimage as gi

    pattern = gi.load_pattern("dress.json")
    image = gi.encode(pattern, grid=16)
    channels = image.to_channels()  # float32 [34, 16, 16]
    again = gi.decode(image)
    gi.save_pattern(again, "dress-again.json")
    worn = gi.drape_pattern(pattern)  # on a body, at rest
    gi.save_png("dress.png", gi.photograph(worn, size=512).colour)

Names are loaded on first use, so importing the package is quick.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
