"""What the command prints: results to stdout, remarks and progress to stderr, one line each."""

import json
import sys
import time
from collections.abc import Iterable, Mapping
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from garmentimage.errors import EncodeError, GarmentImageError
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from garmentimage.networks import StripFrame
    from garmentimage.pattern import Finding, Pattern


PATIENCE = 10.0
"""What takes no longer needs no progress bar [s]."""
USUAL_PART = 3
"""A drape usually comes to rest after this part of its most frames."""


class Exit(IntEnum):
    """Exit codes of the command."""

    OK = 0
    NOT_THE_SAME = 1
    USER_ERROR = 2
    BUG = 3
    INTERRUPTED = 130


class UsageError(Exception):
    """Words that are not a call of the command, in one sentence."""


# --- Results -------------------------------------------------------------------------------------


def list_facts(facts: Mapping[str, Any]) -> str:
    """Facts as a few words."""
    return ", ".join(f"{name} {value}" for name, value in facts.items())


def pattern_facts(pattern: "Pattern") -> dict[str, int]:
    """How many panels, seams and stitches a pattern has.

    A seam is stitches that follow each other on both sides. Images keep seams, not where these are
    divided into stitches.
    """
    from garmentimage.pattern import sewn_runs

    seams = len(sewn_runs(pattern)) // 2
    return {"panels": len(pattern.panels), "seams": seams, "stitches": len(pattern.stitches)}


def print_written(out: Path, facts: Mapping[str, Any], *, as_json: bool, **more: Any) -> None:
    """Report that `out` is written, and what it holds; `more` is for JSON only."""
    if as_json:
        print_json({"out": str(out), **facts, **more})
    else:
        print(f"{shown_path(out)}: written, {list_facts(facts)}")


def print_json(data: Any) -> None:
    """A result as one JSON document."""
    print(json.dumps(data, indent=1))


def garment_facts(garment: "StripFrame") -> dict[str, Any]:
    """A garment that a network made, for JSON."""
    made = garment.garment
    return {
        "panels": len(made.pattern.panels) if made.pattern else 0,
        "repairs": dict(made.repairs.counts) if made.repairs else {},
        "faults": [one_line(fault) for fault in garment.faults],
    }


def garment_words(facts: Mapping[str, Any], *more: str) -> str:
    """The same in words: panels, then the first of `more`, repairs, its others, faults."""
    first, *others = more or ("",)
    parts = [f"{facts['panels']} panels" + (f", {first}" if first else "")]
    repairs = {rule: count for rule, count in facts["repairs"].items() if count}
    parts += [f"repaired: {list_facts(repairs)}"] if repairs else []
    parts += others
    if facts["faults"]:
        parts.append(f"NOT a garment that can be worn: {'; '.join(facts['faults'])}")
    return "; ".join(parts)


# --- Remarks and errors --------------------------------------------------------------------------


def print_line(text: str) -> None:
    """A remark, not a result."""
    print(text, file=sys.stderr)


def print_findings(path: Path, findings: "Iterable[Finding]") -> None:
    """Findings about a file, a line each."""
    for finding in findings:
        print_line(f"warning: {shown_path(path)}: {one_line(finding)}")


def report_error(error: GarmentImageError, *, as_json: bool) -> None:
    """A user's mistake in one sentence, and as a result where JSON is wanted."""
    if as_json:
        print_json(error_facts(error))
    print_line(f"error: {one_line(error)}")


def error_facts(error: GarmentImageError) -> dict[str, Any]:
    """An error for JSON: its class, its message, and the grid that would be fine enough."""
    facts: dict[str, Any] = {"error": type(error).__name__, "message": str(error)}
    if isinstance(error, EncodeError) and error.grid is not None:
        facts["smallest_grid"] = error.grid
    return facts


def one_line(message: object) -> str:
    """The message without line breaks."""
    return " ".join(str(message).split())


# --- Progress ------------------------------------------------------------------------------------


class Progress:
    """A progress bar on stderr, on a terminal only.

    Args:
        unit: of what is counted.
        total: how many there are; None where only `at` knows.
        done: how many were done before, which do not count for the rate.
    """

    def __init__(self, unit: str, total: int | None = None, done: int = 0) -> None:
        from tqdm import tqdm

        self.bar: Any = tqdm(
            total=total, initial=done, unit=unit, disable=None, file=sys.stderr, smoothing=0.05
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def advance(self, count: int = 1, *, is_new: bool = True) -> None:
        """So many more are done; those not `is_new` were done before this run."""
        if is_new:
            self.bar.update(count)
        elif not self.bar.disable:
            self.bar.initial += count
            self.at(self.bar.n + count, self.bar.total)

    def at(self, done: int, total: int) -> None:
        """So many of so many are done; those of the first call were done before this run."""
        if self.bar.total is None:
            self.bar.total, self.bar.initial = total, done
        self.bar.n = done
        self.bar.refresh()

    def restart(self, what: str) -> None:
        """Begin again at 0, for another attempt."""
        self.bar.set_description(what)
        self.bar.reset()

    def show(self, facts: Mapping[str, str]) -> None:
        """Figures beside the bar."""
        self.bar.set_postfix(facts)

    def print(self, text: str, *, is_remark: bool = False) -> None:
        """A line above the bar: a result, or a remark."""
        self.bar.write(text, file=sys.stderr if is_remark else sys.stdout)

    def close(self) -> None:
        """Leave the line of the bar."""
        self.bar.close()


class LongWait:
    """Reports how long something takes that is called frame by frame, and shows a bar.

    Nothing is printed where it takes no longer than `PATIENCE`.
    """

    def __init__(self, doing: str) -> None:
        self.doing = doing
        self.began: float | None = None
        self.first = self.done = 0
        self.progress: Progress | None = None

    def __call__(self, done: int, most: int) -> None:
        """After `done` of at most `most` frames; the first call of each run only takes the time."""
        now = time.perf_counter()
        if self.began is None or done <= self.done:
            self.close()
            self.began, self.first = now, done
        elif self.progress is not None:
            self.progress.advance(done - self.done)
        else:
            seconds = (now - self.began) / (done - self.first) * most / USUAL_PART
            if seconds > PATIENCE:
                print_line(
                    f"{self.doing} takes about {seconds:.0f} s, at most {USUAL_PART} times as long"
                )
                self.progress = Progress("frame", most, done)
        self.done = done

    def close(self) -> None:
        """Leave the line of the bar."""
        if self.progress is not None:
            self.progress.close()
            self.progress = None
