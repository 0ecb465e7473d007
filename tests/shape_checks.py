"""Annotations are laws: in the tests every call of the package is held to its types and shapes.

jaxtyping wraps functions and classes when their module is imported, and beartype checks each call.
Processes that tests start run without it, as users do.
"""

import importlib.util
import sys
from pathlib import Path
from typing import Any, Self

import jaxtyping
from beartype import BeartypeConf, FrozenDict, beartype

PACKAGE = "garmentimage"
UNCHECKED = ("evaluate",)
"""Rooms of networks, whose annotations nobody has held to their calls yet: delete one when done."""
CONF = BeartypeConf(
    is_pep484_tower=True,  # an int passes for a float
    # Of a list the first item is checked, not one by chance: failures repeat, and within its
    # strategies hypothesis wants nobody else to draw from `random`.
    is_random=False,
    # Methods are wrapped one by one, where `Self` has no meaning yet.
    hint_overrides=FrozenDict({Self: object}),
)


def checked(function: Any, *_: Any, **__: Any) -> Any:
    """What jaxtyping wraps functions with."""
    return beartype(conf=CONF)(function)


def checked_modules() -> list[str]:
    """All modules but kernels, which numba compiles; not rooms, whose names mean all in them."""
    spec = importlib.util.find_spec(PACKAGE)
    assert spec is not None and spec.origin is not None
    root = Path(spec.origin).parent
    return [
        ".".join(path.relative_to(root.parent).with_suffix("").parts)
        for path in sorted(root.rglob("*.py"))
        if not path.stem.startswith(("__", "_kernels"))
        and path.relative_to(root).parts[0] not in UNCHECKED
    ]


def check_annotations() -> None:
    """Check every module that is imported from now on; none may have been."""
    assert PACKAGE not in sys.modules, "the package was imported before its checks were installed"
    jaxtyping.install_import_hook(checked_modules(), f"{__name__}.{checked.__name__}")


def set_checks(on: bool) -> None:
    """Whether calls are checked; not in tests of what an argument of a wrong type is answered."""
    jaxtyping.config.update("jaxtyping_disable", not on)
