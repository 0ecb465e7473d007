"""Options that verbs share: their types, their groups, and the files and folders they name."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from importlib.util import find_spec
from math import inf
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter, Token

from garmentimage.cli.terminal import print_findings, print_line
from garmentimage.errors import GarmentImageError, LearnError
from garmentimage.system import check_output, errors_about, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.latent import LatentSpace
    from garmentimage.networks import DecodedGarment, StripFrame
    from garmentimage.pattern import Pattern
    from garmentimage.raster import GarmentImage

IMAGE_SUFFIXES = (".npz", ".npy")
"""Endings of files of GarmentImages."""
DEFAULT_BODY = "mean-female"


# --- Types of values -----------------------------------------------------------------------------


def whole_number(_: object, tokens: Sequence[Token]) -> int:
    """The whole number that a word spells; cyclopts alone would round 1.5."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError from None


def grid_size(_: object, tokens: Sequence[Token]) -> int | Literal["auto"]:
    """A whole number, or "auto"; cyclopts alone would take 2.5 for a 2."""
    return "auto" if tokens[0].value == "auto" else whole_number(_, tokens)


def within(low: float, high: float = inf, unit: str = "") -> Callable[[object, Any], None]:
    """A validator of numbers from `low` to `high`, without an end where `high` is infinite."""
    ends = f"{low:g} or more" if high == inf else f"{low:g} to {high:g}"

    def check(_: object, value: Any) -> None:
        if value is not None and not low <= value <= high:
            raise ValueError(f"give {ends}{unit and ' ' + unit}")

    return check


Results = dict[str | PathLike[str], bytes | str]
"""Contents of files to be written."""
Whole = Annotated[int, Parameter(converter=whole_number)]
Json = Annotated[bool, Parameter(help="Print the result as JSON.")]
Out = Annotated[Path, Parameter(name=("--out", "-o"))]
OutFolder = Annotated[
    Path,
    Parameter(name=("--out", "-o"), metavar="FOLDER", help="Folder of the results."),
]
Files = Annotated[Path, Parameter(required=True)]
"""One or more positional paths."""
Several = Annotated[tuple[str, ...], Parameter(consume_multiple=1, show_default=False)]
"""One or more words after an option, which may be repeated."""
Grid = Annotated[
    Literal["auto"] | int,
    Parameter(
        converter=grid_size,
        help="Cells along each side of the image; auto: the smallest of 16, 32 and 64 that fits.",
    ),
]
Order = Annotated[
    Literal["garmentimage", "authors"] | None,
    Parameter(help="Order of the channels of a .npy file; without it, detected from the values."),
]
MeasuredBody = Annotated[
    str,
    Parameter(metavar="BODY", help="A shipped body, or a JSON file of measurements."),
]
Space = Annotated[str, Parameter(metavar="NAME", help="A bundled latent space, or its folder.")]
Seed = Annotated[Whole, Parameter(validator=within(0))]


# --- Files of patterns and images ----------------------------------------------------------------


def is_image(path: Path) -> bool:
    """Whether a file is named as a GarmentImage."""
    return path.suffix.lower() in IMAGE_SUFFIXES


def read_source(path: Path, order: str | None = None) -> "Pattern | GarmentImage":
    """A pattern or a GarmentImage from its file."""
    if is_image(path):
        from garmentimage.raster import load_image

        return load_image(path, order=order)
    return read_pattern_file(path)


def read_pattern_file(path: Path) -> "Pattern":
    """A pattern from its file; what is odd about it is printed."""
    from garmentimage.pattern.files import read_pattern

    pattern, findings = read_pattern(path)
    print_findings(path, findings)
    return pattern


def read_or_decode(path: Path) -> "Pattern":
    """A pattern from its file, or the one that a GarmentImage holds."""
    if not is_image(path):
        return read_pattern_file(path)
    from garmentimage.raster.decode import decode

    source = read_soft_image(path)
    with errors_about(path):
        return replace(decode(source), name=path.stem)


def read_soft_image(path: Path, order: str | None = None) -> Any:
    """A `.npz` as an image; a `.npy` as channels, so that soft values reach the repair."""
    from garmentimage.raster import load_channels, load_image

    return load_channels(path, order=order) if path.suffix.lower() == ".npy" else load_image(path)


def read_garment(space: "LatentSpace", path: Path, order: str | None = None) -> "DecodedGarment":
    """A garment through a latent space; a warning where the network has not seen the like."""
    source = read_source(path, order)
    with errors_about(path):
        given = space.locate(source)
    unlike = space.out_of_distribution(given)
    if unlike:
        print_line(
            f"warning: {shown_path(path)}: is unlike the garments that {space.folder.name} was "
            f"trained on ({unlike}); expect little, and see `garmentimage nearest`"
        )
    return given


def sound_image(given: "DecodedGarment") -> "GarmentImage":
    """The image of a garment that was read with `read_garment`, which always has one."""
    assert given.image is not None
    return given.image


def garment_files(stem: Path, garment: "StripFrame") -> Results:
    """The files of a garment that a network made: its image, pattern and drape."""
    from garmentimage.drape.files import drape_bytes
    from garmentimage.pattern.files import pattern_text
    from garmentimage.raster import image_bytes

    def path(suffix: str) -> Path:
        return stem.with_name(stem.name + suffix)

    made = garment.garment
    results: Results = {}
    if made.image is not None:
        results[path(".npz")] = image_bytes(made.image)
    if made.pattern is not None:
        results[path(".json")] = pattern_text(made.pattern)
    if garment.worn is not None:
        results[path(".glb")] = drape_bytes(garment.worn, ".glb")
    return results


# --- Folders of results, libraries ---------------------------------------------------------------


def check_folder(out: Path) -> None:
    """Refuse what cannot be a folder of results, before any work is done."""
    try:
        is_file = out.exists() and not out.is_dir()
    except OSError as error:
        raise LearnError(
            f"{shown_path(out)}: cannot be used ({error.strerror}); choose another folder"
        ) from None
    if is_file:
        raise LearnError(f"{shown_path(out)}: is a file; name a folder for the results")


def make_folder(out: Path) -> None:
    """Make the folder of results where there is none."""
    check_folder(out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LearnError(
            f"{shown_path(out)}: cannot be made ({error.strerror}); choose another folder"
        ) from None


def check_results(out: Path, names: Iterable[str], inputs: Iterable[Path]) -> None:
    """Refuse a folder of results in which one of these names is an input."""
    check_folder(out)
    for name in names:
        if (out / name).exists():
            check_output(out / name, (Path(name).suffix,), inputs)


def write_results(out: Path, results: Results, names: Iterable[str]) -> None:
    """Write results to a folder; what an earlier call left under these names is removed."""
    make_folder(out)
    write_together(results)
    for name in names:
        if out / name not in results:
            (out / name).unlink(missing_ok=True)


def need_libraries(
    doing: str, names: Sequence[str], extra: str, error: type[GarmentImageError] = LearnError
) -> None:
    """Refuse to begin without libraries that only an extra of the package installs."""
    for name in names:
        if find_spec(name) is None:
            raise error(f"{doing} needs {name}; install it with `pip install -e '.[{extra}]'`")
