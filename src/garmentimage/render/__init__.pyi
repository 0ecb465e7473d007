from .png import (
    contact_sheet as contact_sheet,
    png_bytes as png_bytes,
    save_png as save_png,
)
from .sheets import (
    show_sheet as show_sheet,
)
from .showing import (
    SUFFIXES as SUFFIXES,
    compose as compose,
    picture_bytes as picture_bytes,
    show as show,
)
from .style import (
    FAINT as FAINT,
    INK as INK,
    NAME_LIMIT as NAME_LIMIT,
    PAPER as PAPER,
    printable as printable,
)
