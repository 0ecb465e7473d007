"""Annotations are laws: in the tests every call of the package is held to its types and shapes.

jaxtyping wraps functions and classes when their module is imported, and beartype checks each call.
Processes that tests start run without it, as users do.
"""

import functools
import importlib.util
import inspect
import sys
from collections.abc import Callable
from dataclasses import is_dataclass
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, Self, get_type_hints

import jaxtyping
from beartype import BeartypeConf, FrozenDict, beartype

PACKAGE = "garmentimage"
CONF = BeartypeConf(
    is_pep484_tower=True,  # an int passes for a float
    # Of a list the first item is checked, not one by chance: failures repeat, and within its
    # strategies hypothesis wants nobody else to draw from `random`.
    is_random=False,
    # Methods are wrapped one by one, where `Self` has no meaning yet.
    hint_overrides=FrozenDict({Self: object}),
)
NEW_NAMES = jaxtyping.jaxtyped("context")
"""Within it, names of axes have no lengths yet."""
_complete = jaxtyping.jaxtyped
_is_on = True
_seen: set[CodeType] = set()


def checked(function: Any, *_: Any, **__: Any) -> Any:
    """What jaxtyping wraps generators with."""
    return beartype(conf=CONF)(function)


def quickly_checked(function: Any = None, *, typechecker: Any) -> Any:
    """`jaxtyping.jaxtyped`, with the same checks at a tenth of the time for each call.

    It checks arguments once and not twice, and does not look for the argument to blame. Of a
    function within a function, which is made anew by each call of the outer one, the first is
    checked.
    """
    if function is None:
        return functools.partial(quickly_checked, typechecker=typechecker)
    if inspect.isclass(function):
        if is_dataclass(function) and "__init__" in vars(function):
            function.__init__ = quickly_checked(function.__init__, typechecker=typechecker)
        return function
    if inspect.isgeneratorfunction(function):  # its body runs after the call
        return _complete(function, typechecker=typechecker)
    if "<locals>" in function.__qualname__:
        if function.__code__ in _seen:
            return function
        _seen.add(function.__code__)
    typed = checked(_with_known_annotations(function))

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        if not _is_on:
            return function(*args, **kwargs)
        with NEW_NAMES:
            return typed(*args, **kwargs)

    return call


def _with_known_annotations(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, annotated with `Any` where names are imported for type checkers only."""
    same = FunctionType(
        function.__code__,
        function.__globals__,
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )
    same.__kwdefaults__ = function.__kwdefaults__
    same.__module__, same.__qualname__ = function.__module__, function.__qualname__
    for name, hint in function.__annotations__.items():

        def one() -> None: ...

        one.__annotations__ = {name: hint}
        try:
            found = get_type_hints(one, function.__globals__, include_extras=True)[name]
        except NameError:
            found = Any
        same.__annotations__[name] = found
    return same


def checked_modules() -> list[str]:
    """All modules but kernels, which numba compiles; not rooms, whose names mean all in them."""
    spec = importlib.util.find_spec(PACKAGE)
    assert spec is not None and spec.origin is not None
    root = Path(spec.origin).parent
    return [
        ".".join(path.relative_to(root.parent).with_suffix("").parts)
        for path in sorted(root.rglob("*.py"))
        if not path.stem.startswith(("__", "_kernels"))
    ]


def check_annotations() -> None:
    """Check every module that is imported from now on; none may have been."""
    assert PACKAGE not in sys.modules, "the package was imported before its checks were installed"
    jaxtyping.jaxtyped = quickly_checked
    jaxtyping.install_import_hook(checked_modules(), f"{__name__}.{checked.__name__}")


def set_checks(on: bool) -> None:
    """Whether calls are checked; not in tests of what an argument of a wrong type is answered."""
    global _is_on
    _is_on = on
    jaxtyping.config.update("jaxtyping_disable", not on)
