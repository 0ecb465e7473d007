from .arrangement import (
    arrange as arrange,
    bounds as bounds,
)
from .drawing import (
    draw_pattern as draw_pattern,
    drawn_size as drawn_size,
)
from .garment_image import (
    CELLS_HEIGHT as CELLS_HEIGHT,
    TYPES_HEIGHT as TYPES_HEIGHT,
    draw_cells as draw_cells,
    draw_image as draw_image,
)
