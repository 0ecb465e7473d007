"""Reading and writing sewing patterns as *specification.json*.

Garment-Pattern-Generator and GarmentCode share this format. We read both of its curvature
syntaxes, any units, relative and absolute control points; we write GarmentCode's syntax in cm with
relative control points. Fields that we do not know come back where they were.

What the format has no place for lives in one field, "garmentimage", beside "pattern":

    "garmentimage": {
      "schema": 1 or 2,
      "panels": {NAME: {
        "holes":       [{"vertices": [...], "edges": [...]}],   as in a panel
        "grain":       [x, y],                                  unit direction of the warp
        "notches":     [{"edge": k, "at": share of its length}],
        "cloth_layer": 1 }},
      "stitches": [{"position": k, "stitch": [...]}],           stitches that touch a hole
      "onto": [{"panel": NAME, "edges": [k, ...],               edges sewn onto cloth: schema 2
                "on": NAME, "matrix": [[a, b], [c, d]],         place on it = matrix @ own place
                "offset": [x, y]}],                             + offset
      "pleats": [{"panel": NAME, "edges": [k, k + 1],           pressed pleats: schema 2
                  "fold": "left", "right", "box" or "inverted",
                  "pressed": length from the edges on}] }

Edges of holes are numbered on after the panel's own edges. A pattern without such things is
written without the field.
"""

import json
import os
import warnings
from pathlib import Path
from typing import Any

from garmentimage.errors import PatternError, PatternFileError, PatternWarning, check_type
from garmentimage.pattern.files.json_file import LongInteger, capped_integer, parse, read_bytes
from garmentimage.pattern.files.spec_reader import read_spec
from garmentimage.pattern.files.spec_writer import pattern_to_spec
from garmentimage.pattern.finding import Finding
from garmentimage.pattern.model import Pattern
from garmentimage.system import errors_about, shown_path, write_atomically


def load_pattern(path: str | os.PathLike[str]) -> Pattern:
    """Read a sewing pattern; what was repaired or looks odd is reported as a `PatternWarning`.

    Raises:
        PatternFileError: the file cannot be read, or does not hold a pattern.
        PatternError: the pattern cannot be sewn; names the panel and the edge.
        StitchError: a stitch joins nothing.
    """
    pattern, found = read_pattern(path)
    for finding in found:
        warnings.warn(f"{shown_path(path)}: {finding}", PatternWarning, stacklevel=2)
    return pattern


def read_pattern(path: str | os.PathLike[str]) -> tuple[Pattern, tuple[Finding, ...]]:
    """Read a sewing pattern, and say what was repaired or looks odd.

    Raises:
        PatternFileError, PatternError, StitchError: as `load_pattern`.
    """
    with errors_about(path):
        raw = read_bytes(path)
        try:
            return read_spec(parse(raw), name=Path(path).stem)
        except LongInteger:
            # Read again with such numbers as infinite, so that the error can name their place.
            read_spec(parse(raw, parse_int=capped_integer))
            raise PatternFileError("holds a number of thousands of digits; remove it") from None


def pattern_from_spec(data: Any, name: str = "") -> Pattern:
    """The pattern that a parsed specification.json describes; warns as `load_pattern` does."""
    pattern, found = read_spec(data, name)
    for finding in found:
        warnings.warn(str(finding), PatternWarning, stacklevel=2)
    return pattern


def save_pattern(pattern: Pattern, path: str | os.PathLike[str]) -> None:
    """Write a pattern as specification.json, whole or not at all; `load_pattern` gives it back.

    Raises:
        PatternError: the pattern has a fault that a file cannot hold (a name twice, an open loop).
        OutputError: the place cannot be written to.
        TypeError: it is not a Pattern.
    """
    check_type(pattern, Pattern, "decode(image) makes one of an image")
    write_atomically(path, pattern_text(pattern))


def pattern_text(pattern: Pattern) -> str:
    """What `save_pattern` writes.

    Raises:
        PatternError: the pattern has a fault that a file cannot hold.
    """
    data = pattern_to_spec(pattern)
    try:
        return json.dumps(data) + "\n"
    except (TypeError, ValueError, RecursionError) as error:
        raise PatternError(f"an extra field cannot be written as JSON ({error})") from None
