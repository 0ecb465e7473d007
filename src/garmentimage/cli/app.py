"""The command `garmentimage`: its verbs, and how their errors become exit codes.

Exit codes: 0 done; 1 a round trip gave back another pattern; 2 invalid input, option or output
path, reported in one sentence, and nothing is written; 3 a bug of ours; 130 stopped with Ctrl-C.
"""

import os
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from garmentimage import __version__
from garmentimage.cli.terminal import Exit, UsageError, one_line, print_line, report_error
from garmentimage.errors import GarmentImageError

if TYPE_CHECKING:
    from cyclopts import App

DEBUG_VARIABLE = "GARMENTIMAGE_DEBUG"
DESCRIPTION = "Sewing patterns as rasters that neural networks understand, and back."
EXIT_CODES = (
    "Exit codes: 0 done, 1 a round trip failed, 2 invalid input, 3 a bug, 130 stopped with Ctrl-C."
)

# cyclopts makes options from typed functions and dataclasses, shows their defaults and choices, and
# loads a verb's module only when it is called; tyro has no groups of verbs and no lazy loading.
VERBS: Mapping[str, Sequence[str]] = MappingProxyType(
    {
        "Patterns": ("pattern:check", "pattern:show"),
        "GarmentImages": ("pattern:encode", "pattern:decode", "pattern:roundtrip"),
        "Draft": ("draft:kinds", "draft:bodies", "draft:draft", "draft:sample", "draft:gallery"),
        "Drape and render": ("drape_and_render:drape", "drape_and_render:render"),
        "Datasets": ("dataset:recipes", "dataset:build", "dataset:dataset"),
        "Pictures and texts to patterns": ("picture_and_text:predict", "picture_and_text:edit"),
        "Latent space": (
            "latent:interpolate",
            "latent:transfer",
            "latent:generate",
            "latent:nearest",
        ),
        "Train and evaluate": ("train:train", "evaluate:evaluate"),
        "Shell": ("usage:completion",),
    }
)
"""Module and function of each verb, by group."""
SUMMARIES: Mapping[str, str] = MappingProxyType({"draft": "Draft a garment of a kind."})
"""Of verbs that are slow to load; the others' are the first lines of their docstrings."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words == ["--version"]:  # answered before cyclopts is loaded
        print(f"garmentimage {__version__}")
        return Exit.OK
    as_json = False
    try:
        from garmentimage.cli.usage import parse

        verb, bound = parse(command_line(), words)
        as_json = bool(bound.arguments.get("json"))
        code: Exit | None = verb(*bound.args, **bound.kwargs)
        sys.stdout.flush()
        return Exit.OK if code is None else code
    except UsageError as error:
        print_line(one_line(error))
        return Exit.USER_ERROR
    except GarmentImageError as error:
        report_error(error, as_json=as_json)
        return Exit.USER_ERROR
    except KeyboardInterrupt:
        print_line("stopped")
        return Exit.INTERRUPTED
    except BrokenPipeError:
        # The reader of our output went away, as `head` does; there is nobody left to inform.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return Exit.OK
    except Exception as error:
        if os.environ.get(DEBUG_VARIABLE):
            raise
        print_line(
            f"a bug in garmentimage ({type(error).__name__}: {one_line(error)}); please report it "
            f"with the file; {DEBUG_VARIABLE}=1 shows where it happened"
        )
        return Exit.BUG


@cache
def command_line() -> "App":
    """All verbs; the module of each is loaded when it is called."""
    from cyclopts import Group

    from garmentimage.cli.usage import group_of_verbs

    app = group_of_verbs("garmentimage", f"{DESCRIPTION}\n\n{EXIT_CODES}", "Options")
    app.version = __version__
    number = 0
    for order, (title, places) in enumerate(VERBS.items()):
        group = Group(title, sort_key=order)
        for place in places:
            name = place.partition(":")[2]
            summary = SUMMARIES.get(name)
            app.command(
                f"garmentimage.cli.{place}", name, group=group, sort_key=number, help=summary
            )
            number += 1
    return app
