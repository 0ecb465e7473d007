"""What may have been meant by a name that does not exist."""

import difflib
from collections.abc import Iterable

_MAX_SHOWN = 12  # names that a message lists; the others are counted


def did_you_mean(name: str, names: Iterable[str], *, otherwise: str | None = None) -> str:
    """The end of a message about a name that does not exist; `names` do.

    Where none of them is near, it is `otherwise`, by default the names to choose from.

    Example:
        >>> did_you_mean("skrit", ["skirt", "dress"])
        'did you mean skirt'
        >>> did_you_mean("coat", ["skirt", "dress"])
        'choose skirt or dress'
    """
    names = list(names)
    close = difflib.get_close_matches(name, names)
    if close:
        return f"did you mean {join_words(close)}"
    if otherwise is not None:
        return otherwise
    more = len(names) - _MAX_SHOWN
    shown = [*names[:_MAX_SHOWN], f"{more} more"] if more > 0 else names
    return f"choose {join_words(shown)}" if shown else "there are none to choose from"


def join_words(things: Iterable[object]) -> str:
    """Things as a sentence lists them: a, b or c."""
    *most, last = map(str, things)
    return f"{', '.join(most)} or {last}" if most else last
