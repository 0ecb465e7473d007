"""A remark about a pattern, and the words that remarks and errors call its parts."""

from collections.abc import Sequence
from dataclasses import dataclass

from garmentimage.errors import quoted

PANELS_NAMED = 3
"""Names that a finding about many panels gives."""


@dataclass(frozen=True)
class Finding:
    """A fact about one place of a pattern that its maker should know."""

    place: str
    message: str
    code: str = ""
    """What it is, for programs; those about placement and units have one."""

    def __str__(self) -> str:
        return f"{self.place}: {self.message}"


def some(names: Sequence[str]) -> str:
    """The first few of many names."""
    shown = ", ".join(quoted(name) for name in names[:PANELS_NAMED])
    more = len(names) - PANELS_NAMED
    return f"{shown} and {more} more" if more > 0 else shown
