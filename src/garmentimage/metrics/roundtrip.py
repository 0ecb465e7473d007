"""Round trips: a pattern encoded as an image and decoded again, judged by `compare_patterns`.

`roundtrip_file` goes through files, a saved image and a saved pattern, twice: with the marks of the
image (names, frames and places of panels) and without. Without marks the frame of a panel is
unknown, so panels may be mirrored or rotated.
"""

import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Literal

import numpy as np

from garmentimage.compare import RoundtripResult, compare_patterns
from garmentimage.errors import GarmentImageError
from garmentimage.metrics.tables import plain_table
from garmentimage.pattern import Pattern
from garmentimage.system import Outcome, TimedOut, map_in_processes

if TYPE_CHECKING:
    from garmentimage.raster import GarmentImage

TIME_LIMIT_S = 60.0
"""Time limit of one file [s]."""

SECOND_CLOTH_LAYER = "collar or lapel"
"""Suffix of the kind of designs that need a second layer of cloth."""


@dataclass(frozen=True)
class RoundTrip:
    """One round trip: the judge's result, or the error that ended it."""

    result: RoundtripResult | None = None
    stage: str = ""
    """Failed step: load, encode, save image, load image, decode, save, reload, judge."""
    error: str = ""
    """Class of the error."""
    message: str = ""
    grid: int | None = None
    """The smallest grid that would suffice, where the encoder knows."""
    times: Mapping[str, float] = field(default_factory=dict)
    """Duration of each step [s]."""

    @property
    def success(self) -> bool:
        """Whether the same pattern came back."""
        return self.result is not None and self.result.success


@dataclass(frozen=True)
class FileReport:
    """The round trip of one file."""

    file: str
    """Folder and name."""
    kind: str
    with_marks: RoundTrip
    without_marks: RoundTrip
    wrapped_panels: int = 0
    """Panels that wrap round the body, from the front layer to the back."""
    is_first: bool = False
    """The first file of its process, whose times include compilation."""


@dataclass(frozen=True)
class KindSummary:
    """Figures of all files of one kind; quality is that of files without an error."""

    kind: str
    files: int
    successes: int
    successes_without_marks: int
    wrapped_files: int
    """Files with panels that wrap round the body."""
    errors: Mapping[str, int]
    """Errors with marks, by class."""
    iou_mean: float | None
    """Mean over all panels."""
    iou_min: float | None
    boundary_gap: float | None
    """Largest distance of a boundary from the original [cm]."""
    seam_agreement: float | None
    """Mean over the files."""
    encode_ms: float | None
    """Median time [ms], without the first file of each process."""
    decode_ms: float | None
    """As `encode_ms`."""


def roundtrip_file(path: str | Path, grid: int | Literal["auto"] = 16) -> FileReport:
    """Round trips of one pattern file, with and without marks.

    Errors are reported, not raised, even those that are bugs.
    """
    from garmentimage.pattern.files import read_pattern
    from garmentimage.raster import save_image
    from garmentimage.raster.encode import encode

    path = Path(path)
    report = partial(FileReport, _short_name(path), garment_kind(path))
    clock = _Clock(path.parent)
    with tempfile.TemporaryDirectory() as folder, clock.catching() as failed:
        with clock.step("load"):
            original, _ = read_pattern(path)
        with clock.step("encode"):
            image = encode(original, grid=grid)
        with clock.step("save image"):
            save_image(image, Path(folder, "image.npz"))
        wrapped = len({m.split_of for m in image.marks if m.split_of is not None})
        saved = Path(folder, "image.npz")
        there = clock.times
        with_marks = _reconstruct(original, saved, Path(folder), keep_marks=True)
        return report(
            replace(with_marks, times={**there, **with_marks.times}),
            _reconstruct(original, saved, Path(folder), keep_marks=False),
            wrapped_panels=wrapped,
        )
    return report(failed[0], failed[0])


def _reconstruct(original: Pattern, saved: Path, folder: Path, *, keep_marks: bool) -> RoundTrip:
    """Decode a saved image to a saved pattern, and judge it."""
    from garmentimage.pattern.files import read_pattern, save_pattern
    from garmentimage.raster import load_image, save_image
    from garmentimage.raster.decode import decode

    clock = _Clock(folder)
    with clock.catching() as failed:
        with clock.step("load image"):
            image: GarmentImage = load_image(saved)
            if not keep_marks:
                save_image(image.without_marks(), folder / "bare.npz")
                image = load_image(folder / "bare.npz")
        with clock.step("decode"):
            decoded = decode(image)
        with clock.step("save"):
            save_pattern(decoded, folder / "pattern.json")
        with clock.step("reload"):
            decoded, _ = read_pattern(folder / "pattern.json")
        with clock.step("judge"):
            result = compare_patterns(original, decoded, any_pose=not keep_marks)
        return RoundTrip(result, times=clock.times)
    return failed[0]


class _Clock:
    """Measures the steps of a round trip, and knows which one failed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        """Removed from messages: a report should not depend on the location of files."""
        self.times: dict[str, float] = {}
        self.stage = ""

    @contextmanager
    def step(self, stage: str) -> Iterator[None]:
        self.stage = stage
        start = perf_counter()
        yield
        self.times[stage] = perf_counter() - start

    @contextmanager
    def catching(self) -> Iterator[list[RoundTrip]]:
        """Catch any error; the list then holds the failed round trip."""
        failed: list[RoundTrip] = []
        try:
            yield failed
        except Exception as error:  # noqa: BLE001 - a failure must not end a run over thousands
            grid = getattr(error, "grid", None) if isinstance(error, GarmentImageError) else None
            failed.append(
                RoundTrip(
                    stage=self.stage,
                    error=type(error).__name__,
                    message=str(error).replace(f"{self.folder}{os.sep}", ""),
                    grid=grid,
                    times=self.times,
                )
            )


def roundtrip_many(
    paths: Sequence[str | Path],
    grid: int | Literal["auto"] = 16,
    *,
    workers: int | None = None,
    progress: Callable[[FileReport], None] | None = None,
    time_limit: float = TIME_LIMIT_S,
) -> list[FileReport]:
    """The round trips of many files, in the order of `paths`.

    Args:
        paths: pattern files.
        grid: cells along each side, or "auto".
        workers: processes; default: one for each core. 0: this process, no time limit.
        progress: called with each report, in order of completion.
        time_limit: a file that takes longer [s] counts as an error.
    """
    work = partial(roundtrip_file, grid=grid)
    reports: dict[int, FileReport] = {}
    count = workers if workers is not None else os.cpu_count() or 1
    if count == 0:
        outcomes: Iterator[Outcome[FileReport]] = (
            Outcome(k, work(path), is_first=k == 0) for k, path in enumerate(paths)
        )
    else:
        outcomes = map_in_processes(work, paths, workers=count, time_limit=time_limit)
    for outcome in outcomes:
        report = outcome.result
        if isinstance(report, TimedOut):
            path = Path(paths[outcome.number])
            trip = RoundTrip(stage="run", error="TimedOut", message=report.reason)
            report = FileReport(_short_name(path), garment_kind(path), trip, trip)
        report = replace(report, is_first=outcome.is_first)
        reports[outcome.number] = report
        if progress is not None:
            progress(report)
    return [reports[k] for k in range(len(paths))]


def garment_kind(path: str | Path) -> str:
    """The kind of garment in a file: the name of its folder.

    A folder of designs may have a manifest, FOLDER_manifest.json in it or beside it: a list of
    designs with `id` and `collar_panels`. Designs with such panels are a separate kind, since a
    collar or lapel is a second layer of cloth.
    """
    path = Path(path).resolve()
    folder = path.parent.name
    if path.stem in _designs_with_collar(path.parent):
        return f"{folder}, {SECOND_CLOTH_LAYER}"
    return folder


@cache
def _designs_with_collar(folder: Path) -> frozenset[str]:
    for place in (folder, folder.parent):
        manifest = place / f"{folder.name}_manifest.json"
        if manifest.is_file():
            designs = json.loads(manifest.read_text(encoding="utf-8"))
            return frozenset(d["id"] for d in designs if d.get("collar_panels"))
    return frozenset()


def _short_name(path: Path) -> str:
    path = path.resolve()
    return f"{path.parent.name}/{path.name}"


def summarise(reports: Sequence[FileReport]) -> list[KindSummary]:
    """One row for each kind, by name, and one for all together."""
    kinds = sorted({r.kind for r in reports})
    rows = [_summary(kind, [r for r in reports if r.kind == kind]) for kind in kinds]
    return rows if len(kinds) == 1 else [*rows, _summary("all", reports)]


def _summary(kind: str, reports: Sequence[FileReport]) -> KindSummary:
    results = [r.with_marks.result for r in reports if r.with_marks.result is not None]
    ious = [iou for result in results for iou in result.iou.values()]
    errors = sorted(r.with_marks.error for r in reports if r.with_marks.error)
    return KindSummary(
        kind=kind,
        files=len(reports),
        successes=sum(r.with_marks.success for r in reports),
        successes_without_marks=sum(r.without_marks.success for r in reports),
        wrapped_files=sum(r.wrapped_panels > 0 for r in reports),
        errors={name: errors.count(name) for name in errors},
        iou_mean=_mean(ious),
        iou_min=min(ious, default=None),
        boundary_gap=max((result.boundary_gap for result in results), default=None),
        seam_agreement=_mean([result.seam_agreement for result in results]),
        encode_ms=_median_ms(reports, "encode"),
        decode_ms=_median_ms(reports, "decode"),
    )


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _median_ms(reports: Sequence[FileReport], step: str) -> float | None:
    warm = [r.with_marks.times for r in reports if not r.is_first]
    times = [times[step] for times in warm if step in times]
    return 1000 * float(np.median(times)) if times else None


_COLUMNS: Mapping[str, Callable[[KindSummary], str]] = {
    "kind": lambda row: row.kind,
    "files": lambda row: str(row.files),
    "success": lambda row: str(row.successes),
    "%": lambda row: f"{100 * row.successes / row.files:.1f}" if row.files else "-",
    "no marks": lambda row: str(row.successes_without_marks),
    "wraps": lambda row: str(row.wrapped_files),
    "IoU mean": lambda row: _shown(row.iou_mean, 4),
    "IoU min": lambda row: _shown(row.iou_min, 4),
    "gap cm": lambda row: _shown(row.boundary_gap, 2),
    "seams": lambda row: _shown(row.seam_agreement, 4),
    "encode ms": lambda row: _shown(row.encode_ms, 1),
    "decode ms": lambda row: _shown(row.decode_ms, 1),
    "errors": lambda row: ", ".join(f"{n} {name}" for name, n in row.errors.items()) or "-",
}


def summary_table(rows: Sequence[KindSummary]) -> str:
    """Figures as a table of plain text."""
    cells = [[cell(row) for cell in _COLUMNS.values()] for row in rows]
    return plain_table([list(_COLUMNS), *cells], left=(0, len(_COLUMNS) - 1))


def _shown(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
