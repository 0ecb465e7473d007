"""A remark about a pattern, and the words that remarks and errors call its parts."""

from collections.abc import Sequence
from dataclasses import dataclass

from garmentimage.errors import quoted

MAX_SHOWN = 3  # names or numbers that a finding about many panels or edges gives


@dataclass(frozen=True)
class Finding:
    """A fact about one place of a pattern that its maker should know."""

    place: str
    message: str
    code: str = ""
    """What it is, for programs; those about placement and units have one."""

    def __str__(self) -> str:
        return f"{self.place}: {self.message}"


def some(things: Sequence[str | int]) -> str:
    """The first few of many names or numbers."""
    shown = ", ".join(quoted(x) if isinstance(x, str) else str(x) for x in things[:MAX_SHOWN])
    more = len(things) - MAX_SHOWN
    return f"{shown} and {more} more" if more > 0 else shown
