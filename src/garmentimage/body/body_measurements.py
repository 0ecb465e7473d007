"""Body measurements: what a tailor's tape and a height stick read off a body, in cm.

Names follow ISO 8559-1. The words used below:

    cervical          the bump of the 7th neck vertebra, where the neck bends into the back
    neck point        where the side of the neck meets the shoulder line (`hps` in a draft)
    shoulder point    the outer end of the shoulder bone, where a sleeve seam sits
    level             a height above the floor at which a girth is taken
"""

import json
import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

from garmentimage.errors import DraftError, quoted
from garmentimage.system import did_you_mean, shown_path, write_atomically

SHIPPED_FILE = "measurements.json"
"""The records of the shipped bodies, in the package's `body/data`."""
SHOWN = 5
"""Names of missing measurements that a message shows."""


@dataclass(frozen=True)
class BodyMeasurements:
    """One adult body as a drafter needs it; every field in cm, the body standing upright."""

    stature: float
    """Floor to the top of the head."""
    cervical_height: float
    """Floor to the 7th neck vertebra."""
    neck_point_height: float
    """Floor to the neck point."""
    shoulder_height: float
    """Floor to the shoulder point."""
    bust_height: float
    """Floor to the level of the bust points."""
    waist_height: float
    """Floor to the natural waist."""
    hip_height: float
    """Floor to where the seat stands out most."""
    crotch_height: float
    """Floor to the crotch, along the inside of the leg."""
    knee_height: float
    """Floor to the middle of the kneecap."""
    ankle_height: float
    """Floor to where the leg is thinnest above the ankle."""

    head_girth: float
    """Round the head above the brows."""
    neck_base_girth: float
    """Round the base of the neck: cervical, both neck points, the pit between the collar bones."""
    bust_girth: float
    """Level, over the bust points."""
    underbust_girth: float
    """Level, just below the breasts."""
    waist_girth: float
    """Level, at the natural waist."""
    hip_girth: float
    """Level, where the seat stands out most."""
    thigh_girth: float
    """Round one leg, just below the crotch."""
    knee_girth: float
    """Round one knee, at the middle of the kneecap."""
    calf_girth: float
    """Round the thickest place of one calf."""
    ankle_girth: float
    """Round the thinnest place of one leg above the ankle."""
    upper_arm_girth: float
    """Round one arm, midway from shoulder point to elbow."""
    wrist_girth: float
    """Round one wrist."""

    shoulder_length: float
    """Neck point to shoulder point, on one side."""
    shoulder_width: float
    """Left to right shoulder point, straight."""
    across_back: float
    """Left to right armhole line over the back, near the middle of the armhole."""
    across_front: float
    """Left to right armhole line over the chest, near the middle of the armhole."""
    bust_point_distance: float
    """Left to right bust point, straight."""
    back_waist_length: float
    """Cervical to waist along the middle of the back."""
    front_waist_length: float
    """Neck point over the bust point to the waist."""
    armscye_depth: float
    """Cervical down the back to the level of the armpits."""
    arm_length: float
    """Shoulder point over the elbow to the wrist."""
    total_crotch_length: float
    """Front waist through between the legs to the back waist."""
    bust_depth: float
    """Front to back of the trunk at bust level."""
    waist_depth: float
    """Front to back of the trunk at waist level."""
    hip_depth: float
    """Front to back of the trunk at hip level."""

    def check(self) -> None:
        """Refuse a body that cannot be.

        Raises:
            DraftError: a measurement is out of its range, or two contradict each other.
        """
        for name, (low, high) in RANGES.items():
            _check_range(name, getattr(self, name), low, high)
        for smaller, larger in ORDERED:
            _check_order(self, smaller, larger)
        for part, whole in PARTS:
            _check_sum(self, part, whole)

    def to_json(self) -> str:
        """The record as one JSON object, fields in the order of the class."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "BodyMeasurements":
        """Read what `to_json` writes.

        Raises:
            DraftError: not JSON, a field missing, unknown or no number, or a body that cannot be.
        """
        try:
            data = json.loads(text)
        except (ValueError, RecursionError):
            raise DraftError(
                "the measurements are not JSON; write one object with a number for each"
            ) from None
        record = cls(**_numbers(data))
        record.check()
        return record


RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "stature": (130.0, 220.0),
        "cervical_height": (105.0, 195.0),
        "neck_point_height": (105.0, 195.0),
        "shoulder_height": (100.0, 190.0),
        "bust_height": (85.0, 170.0),
        "waist_height": (70.0, 150.0),
        "hip_height": (55.0, 125.0),
        "crotch_height": (45.0, 115.0),
        "knee_height": (28.0, 70.0),
        "ankle_height": (4.0, 20.0),
        "head_girth": (45.0, 70.0),
        "neck_base_girth": (28.0, 70.0),
        "bust_girth": (60.0, 190.0),
        "underbust_girth": (50.0, 180.0),
        "waist_girth": (45.0, 190.0),
        "hip_girth": (60.0, 200.0),
        "thigh_girth": (30.0, 110.0),
        "knee_girth": (24.0, 75.0),
        "calf_girth": (22.0, 75.0),
        "ankle_girth": (15.0, 45.0),
        "upper_arm_girth": (16.0, 70.0),
        "wrist_girth": (11.0, 30.0),
        "shoulder_length": (7.0, 22.0),
        "shoulder_width": (26.0, 65.0),
        "across_back": (22.0, 65.0),
        "across_front": (20.0, 65.0),
        "bust_point_distance": (10.0, 40.0),
        "back_waist_length": (26.0, 65.0),
        "front_waist_length": (28.0, 80.0),
        "armscye_depth": (12.0, 40.0),
        "arm_length": (38.0, 85.0),
        "total_crotch_length": (45.0, 140.0),
        "bust_depth": (12.0, 60.0),
        "waist_depth": (10.0, 65.0),
        "hip_depth": (12.0, 65.0),
    }
)
"""Smallest and largest value of each measurement [cm]: wider than any adult that tables list."""

ORDERED = (
    ("ankle_height", "knee_height"),
    ("knee_height", "crotch_height"),
    ("crotch_height", "hip_height"),
    ("hip_height", "waist_height"),
    ("waist_height", "bust_height"),
    ("bust_height", "shoulder_height"),
    ("shoulder_height", "neck_point_height"),
    ("shoulder_height", "cervical_height"),
    ("neck_point_height", "stature"),
    ("cervical_height", "stature"),
    ("thigh_girth", "hip_girth"),
    ("knee_girth", "thigh_girth"),
    ("ankle_girth", "knee_girth"),
    ("ankle_girth", "calf_girth"),
    ("wrist_girth", "upper_arm_girth"),
    ("underbust_girth", "bust_girth"),
    ("neck_base_girth", "bust_girth"),
    ("armscye_depth", "back_waist_length"),
    ("bust_point_distance", "across_front"),
)
"""Pairs of which the first is smaller than the second on every body."""

PARTS = (
    (("bust_depth", "bust_depth"), "bust_girth"),
    (("waist_depth", "waist_depth"), "waist_girth"),
    (("hip_depth", "hip_depth"), "hip_girth"),
    (("across_back", "across_front"), "bust_girth"),
)
"""Pairs of lengths that a girth goes round, so that together they are shorter than it."""

NAMES = tuple(field.name for field in fields(BodyMeasurements))


@cache
def presets() -> Mapping[str, BodyMeasurements]:
    """The measurements of the shipped bodies, by name."""
    text = files("garmentimage.body").joinpath("data", SHIPPED_FILE).read_text("utf-8")
    return MappingProxyType(
        {name: BodyMeasurements(**record) for name, record in json.loads(text).items()}
    )


def measurements(name: str) -> BodyMeasurements:
    """The measurements of one shipped body.

    Raises:
        DraftError: there is no body of that name.
    """
    check_body_name(name)
    return presets()[name]


def check_body_name(name: str) -> None:
    """Refuse a name that no shipped body has, naming the near ones."""
    if name not in presets():
        raise DraftError(f"there is no body {quoted(name)}; {did_you_mean(name, presets())}")


def load_measurements(path: str | os.PathLike[str]) -> BodyMeasurements:
    """Read one record from a JSON file.

    Raises:
        DraftError: the file cannot be read, or is not the record of a possible body.
    """
    try:
        return BodyMeasurements.from_json(Path(path).read_text("utf-8"))
    except DraftError as error:
        raise DraftError(f"{shown_path(path)}: {error}") from None
    except UnicodeDecodeError:
        raise DraftError(f"{shown_path(path)}: is not text; save it as UTF-8 JSON") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise DraftError(
            f"{shown_path(path)}: cannot be read ({reason}); name a file of body measurements"
        ) from None


def save_measurements(path: str | os.PathLike[str], record: BodyMeasurements) -> None:
    """Write one record as JSON, whole or not at all."""
    write_atomically(path, record.to_json())


def _numbers(data: Any) -> dict[str, float]:
    """The fields of a JSON value, if they are exactly those of `BodyMeasurements`."""
    if not isinstance(data, dict):
        raise DraftError("the measurements must be one JSON object with a number for each")
    if "pattern" in data:
        raise DraftError(
            "is a pattern, not measurements; `garmentimage bodies mean-female -o me.json` makes "
            "such a file"
        )
    for name in data:
        if name not in NAMES:
            hint = did_you_mean(name, NAMES, otherwise="remove it")
            raise DraftError(f"there is no measurement {quoted(name)}; {hint}")
    missing = [name for name in NAMES if name not in data]
    if missing:
        more = f" and {len(missing) - SHOWN} more" if len(missing) > SHOWN else ""
        names = ", ".join(missing[:SHOWN])
        raise DraftError(f"the measurements lack {names}{more}; add what is missing [cm]")
    return {name: _number(name, data[name]) for name in NAMES}


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise DraftError(f"{name} must be a number of cm, not {json.dumps(value)[:40]}")
    try:
        return float(value)
    except OverflowError:  # an integer beyond every float
        return math.inf


def _check_range(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise DraftError(
            f"{name} is {value:g} cm, which no adult body has; give {low:g} to {high:g} cm"
        )


def _check_order(body: BodyMeasurements, smaller: str, larger: str) -> None:
    a, b = getattr(body, smaller), getattr(body, larger)
    if not a < b:
        raise DraftError(
            f"{smaller} is {a:g} cm and {larger} {b:g} cm, but on every body the first is the "
            "smaller; measure both again"
        )


def _check_sum(body: BodyMeasurements, parts: tuple[str, str], girth: str) -> None:
    length, tape = sum(getattr(body, part) for part in parts), getattr(body, girth)
    if not length < tape:
        text = f"twice {parts[0]}" if parts[0] == parts[1] else " and ".join(parts)
        raise DraftError(
            f"{text} make {length:g} cm, but {girth}, which goes round them, is {tape:g} cm; "
            "measure them again"
        )
