"""The command `garmentimage`: a few lines of terminal over each library call.

Exit codes: 0 done; 1 a round trip gave back another pattern; 2 an input, an option or an output
path that will not do, told in one sentence, and nothing is written; 3 a bug of ours; 130 stopped
with Ctrl-C.
"""

import argparse
import difflib
import os
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from garmentimage import __version__
from garmentimage.cli.pattern import COMMANDS
from garmentimage.cli.terminal import Exit, one_line, report_error, say
from garmentimage.errors import GarmentImageError, quoted

DEBUG_VARIABLE = "GARMENTIMAGE_DEBUG"


class _Parser(argparse.ArgumentParser):
    """A parser that tells a wrong call in one sentence."""

    def error(self, message: str) -> NoReturn:
        say(f"{self.prog}: {message}; see {self.prog} --help")
        sys.exit(Exit.USER_ERROR)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    parser = _parser()
    options, rest = parser.parse_known_args(arguments)
    if rest and not options.takes_rest:
        _refuse(rest[0], options.parser)
    options.rest = rest
    try:
        code = options.run(options)
        sys.stdout.flush()
        return code
    except GarmentImageError as error:
        report_error(error, as_json=options.json)
        return Exit.USER_ERROR
    except KeyboardInterrupt:
        say("stopped")
        return Exit.INTERRUPTED
    except BrokenPipeError:
        # The reader of our output went away, as `head` does; nothing is left to tell anybody.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return Exit.OK
    except Exception as error:  # A bug must not look like a user's mistake.
        if os.environ.get(DEBUG_VARIABLE):
            raise
        say(
            f"a bug in garmentimage ({type(error).__name__}: {one_line(error)}); please report it "
            f"with the file; {DEBUG_VARIABLE}=1 shows where it happened"
        )
        return Exit.BUG


def _refuse(word: str, parser: argparse.ArgumentParser) -> NoReturn:
    """End with what a verb does not know, the option that may have been meant, and its help."""
    known = re.findall(r"--[\w-]+", parser.format_help())
    near = difflib.get_close_matches(word.partition("=")[0], known, n=1)
    parser.error(f"does not know {quoted(word)}" + (f"; did you mean {near[0]}" if near else ""))


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="garmentimage",
        description="Sewing patterns as rasters that neural networks understand, and back.",
        epilog="Exit codes: 0 done, 1 a round trip failed, 2 wrong input, 3 a bug, 130 stopped.",
    )
    parser.add_argument("--version", action="version", version=f"garmentimage {__version__}")
    verbs = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        sub = verbs.add_parser(command.name, help=command.summary, description=command.summary)
        command.add_arguments(sub)
        sub.add_argument("--json", action="store_true", help="print the result as JSON")
        sub.set_defaults(run=command.run, takes_rest=command.takes_rest, parser=sub)
    return parser
