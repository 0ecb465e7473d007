"""The verbs of a latent space of garments: interpolate, transfer, generate, nearest."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from garmentimage.cli.options import (
    Json,
    Order,
    OutFolder,
    Results,
    Space,
    Whole,
    check_folder,
    garment_files,
    read_garment,
    sound_image,
    write_results,
)
from garmentimage.cli.terminal import Progress, garment_facts, garment_words, print_json
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from garmentimage.latent import LatentSpace
    from garmentimage.networks import DecodedGarment, StripFrame

DEFAULT_SPACE = "vae-variety"


@dataclass(frozen=True)
class Column:
    """A garment of a strip."""

    name: str
    """Of its files; empty where it has none."""
    title: str
    step: "DecodedGarment"


def interpolate(
    a: Path,
    b: Path,
    /,
    *,
    out: OutFolder,
    steps: Whole = 9,
    space: Space = DEFAULT_SPACE,
    order: Order = None,
    json: Json = False,
) -> None:
    """Interpolate between two garments in the latent space.

    Args:
        a: A pattern or a GarmentImage.
        b: Another.
        steps: Garments of the interpolation, with both ends.
    """
    from garmentimage.latent import interpolate as interpolate_images

    latent = _load(space, out)
    ends = [read_garment(latent, path, order) for path in (a, b)]
    first, last = map(sound_image, ends)
    made = interpolate_images(latent, first, last, steps)
    columns = [Column(f"step-{k}", f"{k}/{len(made) - 1}", each) for k, each in enumerate(made)]
    before, after = (
        Column("", f"{name}, as given", each) for name, each in zip("AB", ends, strict=True)
    )
    _write(out, [before, *columns, after], len(made) + 2, as_json=json, is_film=True)


def transfer(
    a: Path,
    b: Path,
    c: Path,
    /,
    *,
    out: OutFolder,
    reprojections: Whole = 2,
    strength: float | None = None,
    space: Space = DEFAULT_SPACE,
    order: Order = None,
    json: Json = False,
) -> None:
    """Apply the edit from A to B to another garment C, by latent arithmetic: C + (B - A).

    Args:
        a: A pattern or a GarmentImage before the edit.
        b: The same after the edit.
        c: The garment to edit.
        reprojections: Times that the result is decoded and encoded again.
        strength: Factor of B - A; without it, the least from 1 to 2 that changes the topology.
    """
    from garmentimage.latent import STRENGTHS, transfer as transfer_edit

    latent = _load(space, out)
    given = [read_garment(latent, path, order) for path in (a, b, c)]
    edited = transfer_edit(
        latent,
        *map(sound_image, given),
        reprojections=reprojections,
        strengths=STRENGTHS if strength is None else (strength,),
    )
    columns = [
        Column("", f"{name}, as given", each) for name, each in zip("ABC", given, strict=True)
    ]
    _write(out, [*columns, Column("edited", edited.title, edited.garment)], 4, as_json=json)


def generate(
    *,
    out: OutFolder,
    count: Whole = 6,
    seed: Whole = 0,
    kind: Annotated[str | None, Parameter(name="--type", metavar="TYPE")] = None,
    space: Space = DEFAULT_SPACE,
    json: Json = False,
) -> None:
    """Sample new garments from the latent space.

    Args:
        count: Number of garments.
        seed: The same seed gives the same garments.
        kind: Sample this type only, such as 'top + skirt'.
    """
    from garmentimage.latent import generate as sample

    latent = _load(space, out)
    made = sample(latent, count, seed, type_name=kind)
    columns = (Column(f"garment-{k}", f"seed {seed}, {k}", each) for k, each in enumerate(made))
    _write(out, columns, count, as_json=json)


def nearest(
    garment: Path,
    /,
    *,
    out: OutFolder,
    count: Whole = 5,
    space: Space = DEFAULT_SPACE,
    order: Order = None,
    json: Json = False,
) -> None:
    """Find the training garments that are nearest in the latent space.

    Args:
        garment: A pattern or a GarmentImage.
        count: Number of garments.
    """
    from garmentimage.latent import nearest as find
    from garmentimage.pattern.files import pattern_text
    from garmentimage.render import compose, picture_bytes

    latent = _load(space, out)
    source = read_garment(latent, garment, order)
    found = find(latent, sound_image(source), count)
    results: Results = {
        out / f"{row_id}.json": pattern_text(pattern) for row_id, _, pattern in found
    }
    start = f"{latent.config['recipe']}-"
    titles = [f"{row_id.removeprefix(start)}, {apart:.2f} away" for row_id, apart, _ in found]
    assert source.pattern is not None  # `read_garment` has one
    figure = compose(
        [source.pattern, *(pattern for *_, pattern in found)], titles=[garment.stem, *titles]
    )
    results[out / "nearest.png"] = picture_bytes(figure, "png")
    write_results(out, results, ())
    if json:
        print_json({"out": str(out), "garments": {name: apart for name, apart, _ in found}})
        return
    for row_id, apart, _ in found:
        print(f"{shown_path(out / row_id)}.json: {apart:.2f} away")
    print(f"{shown_path(out / 'nearest.png')}: the garment and all of them")


# --- Shared --------------------------------------------------------------------------------------


def _load(space: str, out: Path) -> "LatentSpace":
    from garmentimage.latent import LatentSpace

    check_folder(out)
    return LatentSpace.load(space)


def _write(
    out: Path, columns: Iterable[Column], count: int, *, as_json: bool, is_film: bool = False
) -> None:
    """Write every garment as pattern, image and drape, a strip of all, and a film.

    Columns without a name are in the strip only, as they are the user's own.
    """
    from garmentimage.networks import animation, strip
    from garmentimage.render import png_bytes

    drawn = list(_draped(columns, count))
    made = {name: column for name, column in drawn if name}
    results: Results = {}
    for name, column in made.items():
        results |= garment_files(out / name, column)
    results[out / "strip.png"] = png_bytes(strip([column for _, column in drawn]))
    if is_film:
        results[out / "film.gif"] = animation(list(made.values()))
    write_results(out, results, _older_files(out, next(iter(made))))
    _report(out, made, as_json=as_json, is_film=is_film)


def _draped(columns: Iterable[Column], count: int) -> "Iterator[tuple[str, StripFrame]]":
    from garmentimage.networks import draped_frame

    with Progress("garment", count) as progress:
        for each in columns:
            yield each.name, draped_frame(each.title, each.step)
            progress.advance()


def _older_files(folder: Path, name: str) -> list[str]:
    """What an earlier run of the same command may have written."""
    word = re.escape(name.rstrip("0123456789"))
    ours = re.compile(rf"{word}\d*\.(json|npz|glb)", re.ASCII)
    found = folder.iterdir() if folder.is_dir() else ()
    return [file.name for file in found if ours.fullmatch(file.name) and file.is_file()]


def _report(out: Path, made: "Mapping[str, StripFrame]", *, as_json: bool, is_film: bool) -> None:
    rows: list[dict[str, Any]] = [
        {"name": name, "title": column.title, **garment_facts(column)}
        for name, column in made.items()
    ]
    if as_json:
        print_json({"out": str(out), "garments": rows})
        return
    for row in rows:
        print(f"{shown_path(out / row['name'])}: {row['title']}, {garment_words(row)}")
    print(f"{shown_path(out / 'strip.png')}: all of them beside each other")
    if is_film:
        print(f"{shown_path(out / 'film.gif')}: forwards and backwards")
