"""What the command says, and how: results to stdout, remarks to stderr, one line each."""

import argparse
import json
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.errors import EncodeError, GarmentImageError, quoted
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from garmentimage.pattern import Finding


PATIENCE = 10.0
"""What takes no longer needs no progress bar [s]."""
USUALLY = 3
"""Something that is done when it comes to rest usually takes this part of its most frames."""


class Exit(IntEnum):
    """What the command tells the shell."""

    OK = 0
    NOT_THE_SAME = 1
    USER_ERROR = 2
    BUG = 3
    INTERRUPTED = 130


@contextmanager
def errors_about(path: Path) -> Iterator[None]:
    """Errors inside are told as being about this file."""
    name = shown_path(path)
    try:
        yield
    except GarmentImageError as error:
        if not str(error).startswith(name):
            error.args = (f"{name}: {error}",)
        raise


def whole_number(text: str) -> int:
    """The value of an option that takes a whole number."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is no whole number") from None


def add_order(parser: argparse.ArgumentParser) -> None:
    """The option that tells the order of channels."""
    parser.add_argument(
        "--order",
        choices=("garmentimage", "authors"),
        help="order of the channels of a .npy (default: told from the values)",
    )


def list_facts(facts: dict[str, Any]) -> str:
    """Facts as a few words."""
    return ", ".join(f"{name} {value}" for name, value in facts.items())


def print_written(options: argparse.Namespace, facts: dict[str, Any], **more: Any) -> None:
    """Tell that `options.out` is written, and what it holds; `more` is for JSON only."""
    if options.json:
        print_json({"out": str(options.out), **facts, **more})
    else:
        print(f"{shown_path(options.out)}: written, {list_facts(facts)}")


def print_json(data: Any) -> None:
    """A result as one JSON document."""
    print(json.dumps(data, indent=1))


def report_error(error: GarmentImageError, *, as_json: bool) -> None:
    """A user's mistake in one sentence, and as a result where JSON is wanted."""
    if as_json:
        print_json(error_facts(error))
    say(f"error: {one_line(error)}")


def error_facts(error: GarmentImageError) -> dict[str, Any]:
    """An error for JSON: its class, its message, and the grid that would do."""
    facts: dict[str, Any] = {"error": type(error).__name__, "message": str(error)}
    if isinstance(error, EncodeError) and error.grid is not None:
        facts["smallest_grid"] = error.grid
    return facts


def warn(path: Path, found: "Iterable[Finding]") -> None:
    """Findings about a file, a line each."""
    for finding in found:
        say(f"warning: {shown_path(path)}: {one_line(finding)}")


def one_line(message: object) -> str:
    """The message without line breaks."""
    return " ".join(str(message).split())


class LongWait:
    """Says how long something takes that is called frame by frame, and shows how far it is.

    Nothing is said where it takes no longer than `PATIENCE`.
    """

    def __init__(self, doing: str) -> None:
        self.doing = doing
        self.began: float | None = None
        self.first = self.done = 0
        self.bar: Any = None

    def __call__(self, done: int, most: int) -> None:
        """After `done` of at most `most` frames; the first call of each run only takes the time."""
        now = time.perf_counter()
        if self.began is None or done <= self.done:
            self.close()
            self.began, self.first = now, done
        elif self.bar is None:
            seconds = (now - self.began) / (done - self.first) * most / USUALLY
            if seconds > PATIENCE:
                self._show(seconds, done, most)
        else:
            self.bar.update(done - self.done)
        self.done = done

    def close(self) -> None:
        """Leave the line of the bar."""
        if self.bar is not None:
            self.bar.close()
            self.bar = None

    def _show(self, seconds: float, done: int, most: int) -> None:
        from tqdm import tqdm

        say(f"{self.doing} takes about {seconds:.0f} s, at most {USUALLY} times as long")
        self.bar = tqdm(total=most, initial=done, unit="frame", disable=None, file=sys.stderr)


def say(text: str) -> None:
    """A remark, not a result."""
    print(text, file=sys.stderr)
