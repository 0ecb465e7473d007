"""The JSON report of a run of round trips."""

import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib import metadata
from typing import Any, Literal

from garmentimage import __version__
from garmentimage.metrics.roundtrip import FileReport, RoundTrip, summarise

REPORT_VERSION = 1
"""Version of the report's layout."""

LIBRARIES = ("numpy", "scipy", "shapely", "numba")
"""Libraries whose versions a report names."""

DIGITS = 6
"""Decimals of the figures in a report."""


def report_to_json(reports: Sequence[FileReport], grid: int | Literal["auto"]) -> dict[str, Any]:
    """A report as plain data: grid, versions, figures for each kind, and every file.

    It has no path beyond a file's folder and name, so it can be kept and compared.
    """
    data = {
        "version": REPORT_VERSION,
        "grid": grid,
        "versions": {
            "garmentimage": __version__,
            "python": platform.python_version(),
            **{name: metadata.version(name) for name in LIBRARIES},
        },
        "summary": [asdict(row) for row in summarise(reports)],
        "files": [
            {
                "file": report.file,
                "kind": report.kind,
                "wrapped_panels": report.wrapped_panels,
                "is_first": report.is_first,
                "with_marks": _trip_to_json(report.with_marks),
                "without_marks": _trip_to_json(report.without_marks),
            }
            for report in reports
        ],
    }
    rounded: dict[str, Any] = _rounded(data)
    return rounded


def _trip_to_json(trip: RoundTrip) -> dict[str, Any]:
    data: dict[str, Any] = {"success": trip.success, "times": dict(trip.times)}
    if trip.result is not None:
        data |= asdict(trip.result)
    else:
        data |= {"stage": trip.stage, "error": trip.error, "message": trip.message}
        data["smallest_grid"] = trip.grid
    return data


def _rounded(value: Any) -> Any:
    """Plain data with every float rounded."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    return round(value, DIGITS) if isinstance(value, float) else value
