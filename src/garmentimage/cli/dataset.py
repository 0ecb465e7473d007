"""The verbs that make and describe datasets: recipes, build, dataset."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from garmentimage.cli.options import Json, OutFolder, Seed, Whole, need_libraries, within
from garmentimage.cli.terminal import Progress, list_facts, print_json, print_line
from garmentimage.errors import DatasetError
from garmentimage.metrics import plain_table
from garmentimage.system import check_output, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.dataset import BuildSettings, FinishedShard

LIBRARIES = ("pyarrow", "distributed")


def recipes(*, json: Json = False) -> None:
    """List the recipes of datasets."""
    from garmentimage.dataset import load_recipe, recipe_names

    found = [load_recipe(name) for name in recipe_names()]
    if json:
        print_json(
            {r.name: {"doc": r.doc, "types": [t.name for t in r.types], "presets": dict(r.presets)}
             for r in found}
        )  # fmt: skip
    else:
        print(plain_table([[each.name, each.doc] for each in found], left=(0, 1)))


def build(
    recipe: str,
    /,
    *,
    out: OutFolder,
    count: Annotated[Whole | None, Parameter(validator=within(1))] = None,
    unseen: Whole | None = None,
    preset: Literal["laptop", "paper"] = "laptop",
    seed: Seed = 0,
    grid: Whole = 16,
    workers: Annotated[Whole, Parameter(validator=within(1, 1000))] = 2,
    scheduler: Annotated[str | None, Parameter(metavar="URL")] = None,
    json: Json = False,
) -> None:
    """Build a dataset, or resume one that was interrupted.

    Args:
        recipe: A recipe, such as d2; `garmentimage recipes` lists them.
        count: Rows of each type; without it, those of the preset.
        unseen: Rows of each type that is for test only; without it, as many as of the others.
        preset: Rows of each type: laptop, a few; paper, as many as there.
        seed: The same seed gives the same rows, on any number of workers.
        grid: Cells along each side of the images.
        workers: Processes on this machine.
        scheduler: Address of a running Dask scheduler, such as tcp://host:8786, used instead.
    """
    from garmentimage.dataset import load_recipe

    chosen = load_recipe(recipe)
    if preset != "laptop" and count is not None:
        raise DatasetError("give --count or --preset, not both")
    need_libraries("a dataset", LIBRARIES, "data", DatasetError)
    from garmentimage.dataset import BuildSettings, build_dataset, plan_shards

    rows = chosen.presets[preset] if count is None else count
    settings = BuildSettings(chosen, out, rows, seed, grid, unseen)
    with Progress("row", sum(len(shard.places) for shard in plan_shards(settings))) as progress:

        def advance(done: "FinishedShard", is_new: bool) -> None:
            progress.advance(done.rows + len(done.failed), is_new=is_new)

        summary = build_dataset(
            settings,
            scheduler=scheduler,
            workers=workers,
            progress=advance,
            command=_command(settings),
        )
    _print_summary(out, summary, as_json=json)


def _command(settings: "BuildSettings") -> str:
    """The command that makes the same rows again."""
    options = {
        "--count": settings.count,
        "--unseen": settings.unseen,
        "--seed": settings.seed,
        "--grid": settings.grid,
        "-o": settings.folder,
    }
    words = (str(w) for name, value in options.items() if value is not None for w in (name, value))
    return shlex.join(["garmentimage", "build", settings.recipe.name, *words])


def dataset(
    folder: Path,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=("--out", "-o"), metavar="SHEET.png")] = None,
    rows: Annotated[Whole, Parameter(validator=within(1, 100))] = 12,
    json: Json = False,
) -> None:
    """Describe a dataset, and draw some of its rows.

    Args:
        folder: A dataset that `build` wrote.
        out: Picture of some rows.
        rows: Rows that are drawn.
    """
    if out is not None:
        check_output(out, (".png",), [])
        if folder.resolve() in out.resolve().parents:
            raise DatasetError(
                f"{shown_path(out)}: lies in the dataset itself; choose another folder"
            )
    need_libraries("a dataset", LIBRARIES, "data", DatasetError)
    from garmentimage.dataset import read_summary, row_sheet
    from garmentimage.render import png_bytes

    summary = read_summary(folder)
    if out is not None:
        write_atomically(out, png_bytes(row_sheet(folder, rows)))
    _print_summary(folder, summary, as_json=json)


def _print_summary(folder: Path, summary: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print_json({"folder": str(folder), **summary})
        return
    drawn = sum(summary["failed"].values()) + summary["rows"]
    print(
        f"{shown_path(folder)}: {summary['rows']:,} rows of {drawn:,} drawn, "
        f"{list_facts(summary['splits'])}"
    )
    for cause, number in summary["failed"].items():
        print_line(f"no row because of {cause}: {number}")
