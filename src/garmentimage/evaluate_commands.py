"""The verb of the command line that measures networks: evaluate."""

import argparse
import json
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.errors import LearnError
from garmentimage.files import shown_path, write_atomically
from garmentimage.terminal import Exit, print_json, whole_number

if TYPE_CHECKING:
    from garmentimage.evaluate.explore import Amounts, Judged

SUBJECTS = ("explore",)
LEVELS = ("full", "paper", "none")


def evaluate_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `evaluate`."""
    parser.add_argument("subject", metavar="SUBJECT", help="explore: interpolation and edits")
    parser.add_argument(
        "--data", type=Path, required=True, metavar="FOLDER", help="the dataset of the networks"
    )
    parser.add_argument("--vae", metavar="NAME", help="a latent space or its folder")
    parser.add_argument("--vectors", metavar="FOLDER", help="a vector VAE of the same dataset")
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="for records and tables"
    )
    for name, default in (("garments", 300), ("pairs", 200), ("triplets", 100)):
        parser.add_argument(
            f"--{name}", type=whole_number, default=default, metavar="N", help=f"({default})"
        )
    parser.add_argument("--workers", type=whole_number, default=2, metavar="N", help="(2)")


def run_evaluate(options: argparse.Namespace) -> Exit:
    """Measure networks, and write tables and figures."""
    if options.subject not in SUBJECTS:
        raise LearnError(f"there is no subject {options.subject!r}; choose {SUBJECTS[0]}")
    from garmentimage.dataset.sheet import dataset_hash, summary_of
    from garmentimage.evaluate.edits import EDITS
    from garmentimage.evaluate.explore import Amounts, evaluate, facts
    from garmentimage.evaluate.table import markdown
    from garmentimage.provenance import source_commit

    recipe = summary_of(options.data)["recipe"]
    if recipe not in EDITS:
        raise LearnError(f"{shown_path(options.data)}: is of no recipe for {options.subject}")
    networks = _networks(options)
    for name in ("garments", "pairs", "triplets", "workers"):
        if getattr(options, name) < 1:
            raise LearnError(f"--{name} is {getattr(options, name)}; give 1 or more")
    amounts = Amounts(options.garments, options.pairs, options.triplets)
    with _Bar() as bar:
        figures = evaluate(
            networks, recipe, options.out, amounts, workers=options.workers, progress=bar.at
        )
    result = {
        "recipe": recipe,
        "commit": source_commit(),
        "date": datetime.now(UTC).date().isoformat(),
        "data_sha256": dataset_hash(options.data),
        **facts(networks, amounts),
        "figures": figures,
    }
    write_atomically(options.out / "result.json", json.dumps(result, indent=1) + "\n")
    write_atomically(options.out / "table.md", markdown(figures))
    _draw(options.out, networks, recipe, amounts)
    if options.json:
        print_json(result)
    else:
        print(markdown(figures))
        print(f"{shown_path(options.out)}: records, result.json, table.md and figures")
    return Exit.OK


def _networks(options: argparse.Namespace) -> list["Judged"]:
    from garmentimage.evaluate.explore import Judged
    from garmentimage.explore.space import LatentSpace

    data, networks = str(options.data), []
    if options.vae is not None:
        folder = str(LatentSpace.load(options.vae).folder)
        networks += [Judged(f"raster, {level}", folder, data, level) for level in LEVELS]  # type: ignore[arg-type]
    if options.vectors is not None:
        if not (Path(options.vectors) / "model.safetensors").is_file():
            raise LearnError(f"{shown_path(options.vectors)}: holds no network")
        networks.append(Judged("vectors", str(options.vectors), data, None))
    if not networks:
        raise LearnError("name a network with --vae or --vectors")
    return [*networks, Judged("no network", "", data, "full")]


def _draw(folder: Path, networks: Sequence["Judged"], recipe: str, amounts: "Amounts") -> None:
    """The first pair across types, and the first triplet of each edit, through each network."""
    from garmentimage.evaluate.explore import STEPS, codec_of, pairs_of, triplets_of
    from garmentimage.evaluate.figure import edit_picture, way_picture
    from garmentimage.render.png import png_bytes

    codecs = {
        judged.name.removesuffix(", full"): codec_of(judged)
        for judged in networks
        if judged.level in ("full", None)
    }
    a, b, _ = pairs_of(networks[0].data, amounts.pairs)[min(1, amounts.pairs - 1)]
    write_atomically(folder / "way.png", png_bytes(way_picture(codecs, a, b, STEPS)))
    drawn = set()
    for triplet in triplets_of(recipe, amounts.triplets):
        name = triplet.edit.name
        if name not in drawn:
            drawn.add(name)
            file = f"edit-{name.replace(' + ', ' ').replace(' ', '-')}.png"
            write_atomically(folder / file, png_bytes(edit_picture(codecs, triplet)))


class _Bar:
    """Progress by garments measured."""

    def __init__(self) -> None:
        from tqdm import tqdm

        self.bar: Any = tqdm(unit="garment", disable=None, file=sys.stderr, smoothing=0.05)

    def __enter__(self) -> "_Bar":
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.close()

    def at(self, done: int, total: int) -> None:
        """So many of so many are measured."""
        if self.bar.total is None:  # What was measured before does not count for the rate.
            self.bar.total, self.bar.initial = total, done
        self.bar.n = done
        self.bar.refresh()
