"""Recipes: the contents of a dataset, as TOML.

Terms:

- A **type** is a kind of garment with some parameters fixed: tops with sleeves + trousers are the
  kind `top-pants` with `sleeves = "set-in"`.
- A type is **seen** (its rows are for training, validation and test) or **unseen**: all its rows
  are for test, so that no model has seen its topology in training.
- A **preset** is a number of rows a type: `paper` as in the paper, `laptop` for two cores.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from garmentimage.body import presets
from garmentimage.draft import KINDS, Value, checked_values
from garmentimage.drape import FABRICS
from garmentimage.errors import DatasetError, GarmentImageError, quoted
from garmentimage.render.worn import VIEWS, Look, Tint, rgb
from garmentimage.system import did_you_mean

SPLITS = ("train", "validation", "test", "unseen")
SHARES = (0.9, 0.05, 0.05)
"""Shares of the rows of a seen type that are for training, validation and test."""
PERIOD = 20
"""The shares hold exactly for every so many consecutive rows of a type."""
LOOKS = ("plain", "random")
PICTURE_SIZES = (16, 1024)
MAX_ROWS = 10_000_000
"""Rows of a dataset."""
_KIND_NAMES = {
    str: "text",
    int: "a whole number",
    bool: "true or false",
    list: "a list",
    dict: "a table",
}
_TYPE_KEYS = {"name": str, "kind": str, "fixed": dict, "seen": bool}
_KEYS = {
    "name": str, "version": int, "doc": str, "bodies": list, "test_bodies": list, "fabrics": list,
    "views": list, "picture": int, "look": str, "colours": dict, "presets": dict, "types": list,
}  # fmt: skip
_NAME = re.compile("[a-z0-9][a-z0-9-]{0,39}")


@dataclass(frozen=True)
class GarmentType:
    """A kind of garment with some parameters fixed."""

    name: str
    kind: str
    fixed: Mapping[str, Value]
    seen: bool


@dataclass(frozen=True)
class Recipe:
    """The contents of a dataset."""

    name: str
    version: int
    """Incremented whenever the same seed would give other rows."""
    doc: str
    types: tuple[GarmentType, ...]
    bodies: tuple[str, ...]
    """Bodies that wear the garments; one is drawn for each row."""
    test_bodies: tuple[str, ...]
    """Bodies of test and unseen rows, if these are others."""
    fabrics: tuple[str, ...]
    views: tuple[str, ...]
    """Pictures of each row; without any, nothing is draped."""
    picture: int
    """Rows and columns of a picture [pixel]."""
    look: str
    """`plain` (the paper's), or `random`: light, lens, colours, prints, skin and background."""
    colours: Mapping[str, Tint]
    """Colours of the panel groups in plain pictures."""
    presets: Mapping[str, int]
    """Rows of each type, by preset."""

    def split(self, of: GarmentType, index: int) -> str:
        """The split of a row; it depends only on its type and number.

        Of any twenty rows of a seen type in order, 18 are for training, one for validation and
        one for test, so that a larger dataset has the same rows in the same splits.
        """
        if not of.seen:
            return "unseen"
        places = np.cumsum(np.rint(PERIOD * np.array(SHARES))).astype(int)
        return SPLITS[int(np.searchsorted(places, index % PERIOD, side="right"))]

    def wearers(self, split: str) -> tuple[str, ...]:
        """Bodies that may wear the garments of a split."""
        is_test = split in ("test", "unseen")
        return self.test_bodies if is_test and self.test_bodies else self.bodies


def recipe_names() -> tuple[str, ...]:
    """Names of the bundled recipes."""
    folder = files("garmentimage.dataset") / "recipes"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir()))


@cache
def load_recipe(name: str) -> Recipe:
    """A bundled recipe.

    Raises:
        DatasetError: there is no recipe of that name.
    """
    if name not in recipe_names():
        raise DatasetError(
            f"there is no recipe {quoted(name)}; {did_you_mean(name, recipe_names())}"
        )
    text = (files("garmentimage.dataset") / "recipes" / f"{name}.toml").read_text(encoding="utf-8")
    return parse_recipe(text)


def parse_recipe(text: str) -> Recipe:
    """A recipe from its TOML."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DatasetError(f"the recipe is not TOML: {error}") from None
    except (ValueError, RecursionError):
        raise DatasetError("the recipe has a number too long, or nests too deep") from None
    optional = {"test_bodies", "colours", "look", "picture"}
    _check_keys(data, _KEYS, required=_KEYS.keys() - optional)
    try:
        return _parse(data)
    except GarmentImageError as error:
        raise DatasetError(str(error)) from None


def _parse(data: Mapping[str, Any]) -> Recipe:
    """A recipe from its TOML data, whose keys and kinds of values are checked already."""
    for number in data["presets"].values():
        _check_kind("preset", number, int)
    recipe = Recipe(
        name=data["name"],
        version=data["version"],
        doc=data["doc"],
        types=tuple(_parse_type(each) for each in data["types"]),
        bodies=_check_names(data["bodies"], presets(), "body"),
        test_bodies=_check_names(data.get("test_bodies", ()), presets(), "body"),
        fabrics=_check_names(data["fabrics"], FABRICS, "fabric"),
        views=_check_names(data["views"], VIEWS, "view"),
        picture=data.get("picture", 0),
        look=_check_names([data.get("look", "plain")], LOOKS, "look")[0],
        colours=data.get("colours", {}),
        presets=data["presets"],
    )
    _check_numbers(recipe)
    _check_contents(recipe)
    return recipe


def _check_numbers(recipe: Recipe) -> None:
    """Check the ranges of version, presets and picture size."""
    for what, number in (("version", recipe.version), *recipe.presets.items()):
        if not 1 <= number <= MAX_ROWS:
            raise DatasetError(f"{what} of the recipe is {number}; give 1 to {MAX_ROWS}")
    low, high = PICTURE_SIZES
    if recipe.views and not low <= recipe.picture <= high:
        raise DatasetError(f"pictures of {recipe.picture} pixels; give {low} to {high}")


def _check_contents(recipe: Recipe) -> None:
    """Check names, and values that depend on each other."""
    if not _NAME.fullmatch(recipe.name):
        raise DatasetError(f"a recipe is named by a-z, 0-9 and -, not {quoted(recipe.name)}")
    _check_names(recipe.colours, Look().colours, "panel group")
    if not recipe.types or not recipe.bodies or not recipe.fabrics:
        raise DatasetError("a recipe needs types, bodies and fabrics")
    if len({each.name for each in recipe.types}) < len(recipe.types):
        raise DatasetError("two types of the recipe have one name")
    if set(recipe.bodies) & set(recipe.test_bodies):
        raise DatasetError("the test bodies of a recipe must differ from its bodies")
    for tint in recipe.colours.values():
        rgb(tint)  # raises RenderError


def _parse_type(data: Any) -> GarmentType:
    _check_kind("type", data, dict)
    _check_keys(data, _TYPE_KEYS, required={"name", "kind"})
    (kind,) = _check_names([data["kind"]], KINDS, "kind")
    fixed = data.get("fixed", {})
    if not data["name"]:
        raise DatasetError("a type of the recipe has no name")
    values = checked_values(KINDS[kind].parameters, fixed, f"kind {kind}")
    return GarmentType(
        name=data["name"],
        kind=kind,
        fixed={name: values[name] for name in fixed},
        seen=data.get("seen", True),
    )


def _check_names(names: Any, known: Any, what: str) -> tuple[str, ...]:
    for name in names:
        _check_kind(what, name, str)
        if name not in known:
            raise DatasetError(f"there is no {what} {quoted(name)}; {did_you_mean(name, known)}")
    return tuple(names)


def _check_keys(data: Mapping[str, Any], known: Mapping[str, type], *, required: set[str]) -> None:
    for key, value in data.items():
        if key not in known:
            raise DatasetError(f"a recipe has no {quoted(key)}; {did_you_mean(key, sorted(known))}")
        _check_kind(key, value, known[key])
    for key in sorted(required - data.keys()):
        raise DatasetError(f"the recipe lacks {key}")


def _check_kind(what: str, value: Any, wanted: type) -> None:
    if type(value) is not wanted:
        raise DatasetError(
            f"{what} of the recipe is {quoted(str(value))}; give {_KIND_NAMES[wanted]} there"
        )
