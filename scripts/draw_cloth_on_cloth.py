"""Draw garments with lapels, pockets and pleats: pattern, image, and how they are worn.

python scripts/draw_cloth_on_cloth.py [OUT.png]
"""

import sys
from pathlib import Path

from draw_algorithms import GRID, OUT, PIXELS, PLAIN_TYPES, legend, save
from matplotlib.figure import Figure

import garmentimage as gi
from garmentimage.raster import EdgeType
from garmentimage.render.flat import draw_image, draw_pattern

CLOTH_ON_CLOTH = (
    ("blazer", {"lapel_shape": "notched"}),
    ("pocket-skirt", {}),
    ("pleated-skirt", {"pleats": "knife"}),
)


def draw(out: Path) -> None:
    """Patterns with lapels, pockets and pleats, their images, and how they are worn."""
    figure = Figure(figsize=(13.0, 13.0))
    grid = figure.add_gridspec(
        len(CLOTH_ON_CLOTH),
        3,
        width_ratios=(1.5, 1.5, 0.5),
        left=0.02,
        right=0.98,
        top=0.99,
        bottom=0.06,
    )
    for row, (kind, parameters) in enumerate(CLOTH_ON_CLOTH):
        pattern = gi.draft_pattern(kind, **parameters)
        pattern_ax, image_ax, worn_ax = (figure.add_subplot(grid[row, k]) for k in range(3))
        draw_pattern(pattern, pattern_ax)
        draw_image(gi.encode(pattern, GRID), image_ax, legend=False)
        colour = gi.photograph(gi.drape_pattern(pattern), view="turned", size=PIXELS).colour
        worn_ax.imshow(colour[:, PIXELS // 4 : -PIXELS // 4])
        worn_ax.set_axis_off()
    legend(figure, 0.02, (*PLAIN_TYPES, EdgeType.ONTO, EdgeType.CREASE))
    save(figure, out)


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else OUT / "cloth-on-cloth.png")
