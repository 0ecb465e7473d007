"""The verbs of the command line that make and describe datasets: build, dataset."""

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import Exit, list_facts, print_json, say, whole_number
from garmentimage.errors import DatasetError
from garmentimage.system import check_output, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.dataset import BuildSettings, FinishedShard

PRESET = "laptop"
SHEET_ROWS = 12


def build_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `build`."""
    parser.add_argument("recipe", metavar="RECIPE", help="a recipe, such as d2; `list` lists them")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FOLDER", help="where it goes, or is gone on with"
    )
    parser.add_argument(
        "--count", type=whole_number, metavar="N", help=f"rows of each type (as preset {PRESET})"
    )
    parser.add_argument(
        "--unseen", type=whole_number, metavar="N", help="of each type for test only (the same)"
    )
    parser.add_argument("--preset", help=f"{PRESET} (default), or paper: as many as there")
    parser.add_argument("--seed", type=whole_number, default=0, metavar="N")
    parser.add_argument("--grid", type=whole_number, default=16, metavar="N", help="cells a side")
    parser.add_argument(
        "--workers", type=whole_number, default=2, metavar="N", help="processes here (2)"
    )
    parser.add_argument(
        "--scheduler", metavar="URL", help="a running Dask scheduler, tcp://host:8786, instead"
    )


def run_build(options: argparse.Namespace) -> Exit:
    """Make what is missing of a dataset."""
    from garmentimage.dataset import load_recipe, recipe_names

    if options.recipe == "list":
        return _list_recipes(options, [load_recipe(name) for name in recipe_names()])
    chosen = load_recipe(options.recipe)
    if options.out is None:
        raise DatasetError("name a folder for it with -o")
    if options.preset is not None and options.count is not None:
        raise DatasetError("give --count or --preset, not both")
    preset = options.preset or PRESET
    if preset not in chosen.presets:
        raise DatasetError(f"there is no preset {preset!r}; choose {' or '.join(chosen.presets)}")
    _check_range("--workers", options.workers, 1, 1000)
    _check_range("--seed", options.seed, 0, 2**62)
    _need_extra()
    from tqdm import tqdm

    from garmentimage.dataset import BuildSettings, build_dataset, plan_shards

    count = chosen.presets[preset] if options.count is None else options.count
    what = BuildSettings(chosen, options.out, count, options.seed, options.grid, options.unseen)
    rows = sum(len(shard.places) for shard in plan_shards(what))
    with tqdm(total=rows, unit="row", disable=None, file=sys.stderr, smoothing=0.05) as bar:

        def progress(done: "FinishedShard", fresh: bool) -> None:
            number = done.rows + len(done.failed)
            if fresh:
                bar.update(number)
            elif not bar.disable:  # What was there before does not count for the rate.
                bar.initial += number
                bar.n += number
                bar.refresh()

        summary = build_dataset(
            what,
            scheduler=options.scheduler,
            workers=options.workers,
            progress=progress,
            command=_command(what),
        )
    _tell(options, options.out, summary)
    return Exit.OK


def _command(what: "BuildSettings") -> str:
    """The command that makes the same rows again."""
    options = {
        "--count": what.count,
        "--unseen": what.unseen,
        "--seed": what.seed,
        "--grid": what.grid,
        "-o": what.folder,
    }
    words = (str(w) for name, value in options.items() if value is not None for w in (name, value))
    return shlex.join(["garmentimage", "build", what.recipe.name, *words])


def dataset_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `dataset`."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="what `build` wrote")
    parser.add_argument("-o", "--out", type=Path, metavar="SHEET.png", help="draw some of its rows")
    parser.add_argument("--rows", type=whole_number, default=SHEET_ROWS, metavar="N")


def run_dataset(options: argparse.Namespace) -> Exit:
    """Describe a dataset, and draw some rows of it."""
    _check_range("--rows", options.rows, 1, 100)
    if options.out is not None:
        check_output(options.out, (".png",), [])
        if options.folder.resolve() in options.out.resolve().parents:
            raise DatasetError(
                f"{shown_path(options.out)}: lies in the dataset itself; choose another folder"
            )
    _need_extra()
    from garmentimage.dataset import read_summary, row_sheet
    from garmentimage.render import png_bytes

    summary = read_summary(options.folder)
    if options.out is not None:
        write_atomically(options.out, png_bytes(row_sheet(options.folder, options.rows)))
    _tell(options, options.folder, summary)
    return Exit.OK


def _list_recipes(options: argparse.Namespace, recipes: list[Any]) -> Exit:
    if options.json:
        print_json(
            {r.name: {"doc": r.doc, "types": [t.name for t in r.types], "presets": dict(r.presets)}
             for r in recipes}
        )  # fmt: skip
    else:
        for each in recipes:
            print(f"{each.name:14} {each.doc}")
    return Exit.OK


def _tell(options: argparse.Namespace, folder: Path, summary: dict[str, Any]) -> None:
    if options.json:
        print_json({"folder": str(folder), **summary})
        return
    asked = sum(summary["failed"].values()) + summary["rows"]
    print(
        f"{shown_path(folder)}: {summary['rows']:,} rows of {asked:,} drawn, "
        f"{list_facts(summary['splits'])}"
    )
    for cause, number in summary["failed"].items():
        say(f"no row because of {cause}: {number}")


def _check_range(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high:
        raise DatasetError(f"{name} is {value}; give {low} to {high}")


def _need_extra() -> None:
    from importlib.util import find_spec

    for name in ("pyarrow", "distributed"):
        if find_spec(name) is None:
            raise DatasetError(f"datasets need {name}; install it with `pip install -e '.[data]'`")
