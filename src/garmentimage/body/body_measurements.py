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
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, get_type_hints

from garmentimage.errors import DraftError, quoted
from garmentimage.system import did_you_mean, errors_about, write_atomically

SHIPPED_FILE = "measurements.json"
"""The records of the shipped bodies, in the package's `body/data`."""
MAX_SHOWN = 5  # names of missing measurements that a message shows


@dataclass(frozen=True)
class BodyMeasurements:
    """One adult body as a drafter needs it; every field in cm, the body standing upright.

    Beside each field stand its smallest and its largest value.
    """

    stature: Annotated[float, 130, 220]
    """Floor to the top of the head."""
    cervical_height: Annotated[float, 105, 195]
    """Floor to the 7th neck vertebra."""
    neck_point_height: Annotated[float, 105, 195]
    """Floor to the neck point."""
    shoulder_height: Annotated[float, 100, 190]
    """Floor to the shoulder point."""
    bust_height: Annotated[float, 85, 170]
    """Floor to the level of the bust points."""
    waist_height: Annotated[float, 70, 150]
    """Floor to the natural waist."""
    hip_height: Annotated[float, 55, 125]
    """Floor to where the seat stands out most."""
    crotch_height: Annotated[float, 45, 115]
    """Floor to the crotch, along the inside of the leg."""
    knee_height: Annotated[float, 28, 70]
    """Floor to the middle of the kneecap."""
    ankle_height: Annotated[float, 4, 20]
    """Floor to where the leg is thinnest above the ankle."""

    head_girth: Annotated[float, 45, 70]
    """Round the head above the brows."""
    neck_base_girth: Annotated[float, 28, 70]
    """Round the base of the neck: cervical, both neck points, the pit between the collar bones."""
    bust_girth: Annotated[float, 60, 190]
    """Level, over the bust points."""
    underbust_girth: Annotated[float, 50, 180]
    """Level, just below the breasts."""
    waist_girth: Annotated[float, 45, 190]
    """Level, at the natural waist."""
    hip_girth: Annotated[float, 60, 200]
    """Level, where the seat stands out most."""
    thigh_girth: Annotated[float, 30, 110]
    """Round one leg, just below the crotch."""
    knee_girth: Annotated[float, 24, 75]
    """Round one knee, at the middle of the kneecap."""
    calf_girth: Annotated[float, 22, 75]
    """Round the thickest place of one calf."""
    ankle_girth: Annotated[float, 15, 45]
    """Round the thinnest place of one leg above the ankle."""
    upper_arm_girth: Annotated[float, 16, 70]
    """Round one arm, midway from shoulder point to elbow."""
    wrist_girth: Annotated[float, 11, 30]
    """Round one wrist."""

    shoulder_length: Annotated[float, 7, 22]
    """Neck point to shoulder point, on one side."""
    shoulder_width: Annotated[float, 26, 65]
    """Left to right shoulder point, straight."""
    across_back: Annotated[float, 22, 65]
    """Left to right armhole line over the back, near the middle of the armhole."""
    across_front: Annotated[float, 20, 65]
    """Left to right armhole line over the chest, near the middle of the armhole."""
    bust_point_distance: Annotated[float, 10, 40]
    """Left to right bust point, straight."""
    back_waist_length: Annotated[float, 26, 65]
    """Cervical to waist along the middle of the back."""
    front_waist_length: Annotated[float, 28, 80]
    """Neck point over the bust point to the waist."""
    armscye_depth: Annotated[float, 12, 40]
    """Cervical down the back to the level of the armpits."""
    arm_length: Annotated[float, 38, 85]
    """Shoulder point over the elbow to the wrist."""
    total_crotch_length: Annotated[float, 45, 140]
    """Front waist through between the legs to the back waist."""
    bust_depth: Annotated[float, 12, 60]
    """Front to back of the trunk at bust level."""
    waist_depth: Annotated[float, 10, 65]
    """Front to back of the trunk at waist level."""
    hip_depth: Annotated[float, 12, 65]
    """Front to back of the trunk at hip level."""

    def check(self) -> None:
        """Refuse a body that cannot be.

        Raises:
            DraftError: a measurement is out of its range, or two contradict each other.
        """
        values = asdict(self)
        for name, (low, high) in RANGES.items():
            if not low <= values[name] <= high:
                raise DraftError(
                    f"{name} is {values[name]:g} cm, which no adult body has; "
                    f"give {low:g} to {high:g} cm"
                )
        for smaller, larger in (pair for names in ORDERED for pair in pairwise(names)):
            if not values[smaller] < values[larger]:
                raise DraftError(
                    f"{smaller} is {values[smaller]:g} cm and {larger} {values[larger]:g} cm, but "
                    "on every body the first is the smaller; measure both again"
                )
        for (first, second), girth in PARTS:
            length = values[first] + values[second]
            if not length < values[girth]:
                text = f"twice {first}" if first == second else f"{first} and {second}"
                raise DraftError(
                    f"{text} make {length:g} cm, but {girth}, which goes round them, is "
                    f"{values[girth]:g} cm; measure them again"
                )

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
        name: hint.__metadata__
        for name, hint in get_type_hints(BodyMeasurements, include_extras=True).items()
    }
)
"""Smallest and largest value of each measurement [cm]: wider than any adult that tables list."""

ORDERED = (
    ("ankle_height", "knee_height", "crotch_height", "hip_height", "waist_height", "bust_height"),
    ("bust_height", "shoulder_height", "neck_point_height", "stature"),
    ("shoulder_height", "cervical_height", "stature"),
    ("ankle_girth", "knee_girth", "thigh_girth", "hip_girth"),
    ("ankle_girth", "calf_girth"),
    ("wrist_girth", "upper_arm_girth"),
    ("underbust_girth", "bust_girth"),
    ("neck_base_girth", "bust_girth"),
    ("armscye_depth", "back_waist_length"),
    ("bust_point_distance", "across_front"),
)
"""Measurements of which each is smaller than the next on every body."""

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
    with errors_about(path):
        try:
            text = Path(path).read_text("utf-8")
        except UnicodeDecodeError:
            raise DraftError("is not text; save it as UTF-8 JSON") from None
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise DraftError(
                f"cannot be read ({reason}); name a file of body measurements"
            ) from None
        return BodyMeasurements.from_json(text)


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
        more = f" and {len(missing) - MAX_SHOWN} more" if len(missing) > MAX_SHOWN else ""
        names = ", ".join(missing[:MAX_SHOWN])
        raise DraftError(f"the measurements lack {names}{more}; add what is missing [cm]")
    return {name: _number(name, data[name]) for name in NAMES}


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise DraftError(f"{name} must be a number of cm, not {json.dumps(value)[:40]}")
    try:
        return float(value)
    except OverflowError:  # an integer beyond every float
        return math.inf
