"""The verb of the command line that measures networks: evaluate."""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import Exit, print_json, whole_number
from garmentimage.errors import LearnError, quoted
from garmentimage.system import shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.evaluate import Candidate, EditMethod, ImageAmounts, LatentAmounts, Predictor

LEVELS = ("full", "paper", "none")
EXPLORE = {"garments": 300, "pairs": 200, "triplets": 100}
IMAGE = {"seen": 1000, "unseen": 500, "parts": 300, "draped": 200}
EDIT = {"edited": 24}
"""How many of each are measured, by subject."""
ONLY_OF = {
    "vae": ("explore",),
    "vectors": ("explore", "edit"),
    "recipe": ("image",),
    "network": ("image",),
    "validation": ("image", "edit"),
    "space": ("edit",),
    "pictures": ("edit",),
    "denoiser": ("edit",),
    "vector_pictures": ("edit",),
    "strength": ("edit",),
    "steps": ("edit",),
    "tries": ("edit",),
    **dict.fromkeys(EXPLORE, ("explore",)),
    **dict.fromkeys(IMAGE, ("image",)),
    **dict.fromkeys(EDIT, ("edit",)),
}
"""Subjects that options are of, where they are not of all."""
OF_RUN = ("network", "settings", "config", "without")
SHOWN = 3
"""Garments of each split in the figure of guesses."""


def evaluate_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the evaluation of an image network."""
    parser.add_argument(
        "subject",
        metavar="SUBJECT",
        help="explore: interpolation and edits; image: picture to pattern; edit: edits by text",
    )
    parser.add_argument(
        "--data", type=Path, metavar="FOLDER", help="the dataset of the networks (data/RECIPE)"
    )
    parser.add_argument("--vae", metavar="NAME", help="explore: a latent space or its folder")
    parser.add_argument(
        "--vectors", metavar="FOLDER", help="explore, edit: a vector VAE of that dataset"
    )
    parser.add_argument("--recipe", metavar="RECIPE", help="image: of data/RECIPE, runs/RECIPE-*")
    parser.add_argument(
        "--network",
        action="append",
        metavar="NAME=RUN",
        help="image: instead of runs/RECIPE-*; of one NAME where they differ in their seed",
    )
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="for records and tables"
    )
    parser.add_argument("--space", metavar="NAME", help="edit: a latent space (text-edit)")
    parser.add_argument("--pictures", metavar="NAME", help="edit: its picture network")
    parser.add_argument("--denoiser", metavar="NAME", help="edit: what guides")
    parser.add_argument(
        "--vector-pictures", metavar="FOLDER", help="edit: the picture network of --vectors"
    )
    parser.add_argument("--strength", type=float, metavar="X", help="edit: (1)")
    parser.add_argument("--steps", type=whole_number, metavar="N", help="edit: of each edit")
    parser.add_argument("--tries", type=whole_number, metavar="N", help="edit: most of each edit")
    for subject, amounts in (("explore", EXPLORE), ("image", IMAGE), ("edit", EDIT)):
        for name, default in amounts.items():
            parser.add_argument(
                f"--{name}", type=whole_number, metavar="N", help=f"{subject}: ({default})"
            )
    parser.add_argument(
        "--validation",
        action="store_true",
        default=None,
        help="image, edit: on the validation split, for choices; unseen is what --without left out",
    )
    parser.add_argument("--workers", type=whole_number, default=2, metavar="N", help="(2)")


def run_evaluate(options: argparse.Namespace) -> Exit:
    """Measure networks, and write tables and figures."""
    subjects = {"explore": _run_explore, "image": _run_image, "edit": _run_edit}
    if options.subject not in subjects:
        raise LearnError(
            f"there is no subject {quoted(options.subject)}; choose {' or '.join(subjects)}"
        )
    for name, of in ONLY_OF.items():
        if options.subject not in of and getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            raise LearnError(f"{option} is of `evaluate {'` and `evaluate '.join(of)}` only")
    if options.workers < 1:
        raise LearnError(f"--workers is {options.workers}; give 1 or more")
    return subjects[options.subject](options)


def _amounts(options: argparse.Namespace, known: dict[str, int], least: int) -> dict[str, int]:
    found = {}
    for name, default in known.items():
        given = getattr(options, name)
        found[name] = default if given is None else given
        if found[name] < least:
            raise LearnError(f"--{name} is {found[name]}; give {least} or more")
    return found


# --- Exploring -----------------------------------------------------------------------------------


def _run_explore(options: argparse.Namespace) -> Exit:
    from garmentimage.dataset import dataset_hash, read_summary
    from garmentimage.evaluate import (
        EDITS,
        LatentAmounts,
        describe_run,
        evaluate_latent,
        latent_table,
    )

    if options.data is None:
        raise LearnError("name the dataset of the networks with --data")
    recipe = read_summary(options.data)["recipe"]
    if recipe not in EDITS:
        raise LearnError(f"{shown_path(options.data)}: is of no recipe for explore")
    networks = _networks(options)
    amounts = LatentAmounts(**_amounts(options, EXPLORE, 1))
    with _Bar() as bar:
        figures = evaluate_latent(
            networks, recipe, options.out, amounts, workers=options.workers, progress=bar.at
        )
    result = {
        **_provenance(recipe),
        "data_sha256": dataset_hash(options.data),
        **describe_run(networks, amounts),
        "figures": figures,
    }
    _put(options.out, result, latent_table(figures))
    _draw(options.out, networks, recipe, amounts)
    return _say(options, options.out, result, latent_table(figures))


def _networks(options: argparse.Namespace) -> list["Candidate"]:
    from garmentimage.evaluate import Candidate
    from garmentimage.latent import LatentSpace

    data, networks = str(options.data), []
    if options.vae is not None:
        folder = str(LatentSpace.load(options.vae).folder)
        networks += [Candidate(f"raster, {level}", folder, data, level) for level in LEVELS]  # type: ignore[arg-type]
    if options.vectors is not None:
        if not (Path(options.vectors) / "model.safetensors").is_file():
            raise LearnError(f"{shown_path(options.vectors)}: holds no network")
        networks.append(Candidate("vectors", str(options.vectors), data, None))
    if not networks:
        raise LearnError("name a network with --vae or --vectors")
    return [*networks, Candidate("no network", "", data, "full")]


def _draw(
    folder: Path, networks: Sequence["Candidate"], recipe: str, amounts: "LatentAmounts"
) -> None:
    """The first pair across types, and the first triplet of each edit, through each network."""
    from garmentimage.evaluate import (
        INTERPOLATION_STEPS,
        draw_pairs,
        draw_triplets,
        edit_picture,
        interpolation_picture,
        load_codec,
    )
    from garmentimage.render import png_bytes

    codecs = {
        judged.name.removesuffix(", full"): load_codec(judged)
        for judged in networks
        if judged.level in ("full", None)
    }
    a, b, _ = draw_pairs(networks[0].data, amounts.pairs)[min(1, amounts.pairs - 1)]
    write_atomically(
        folder / "way.png", png_bytes(interpolation_picture(codecs, a, b, INTERPOLATION_STEPS))
    )
    drawn = set()
    for triplet in draw_triplets(recipe, amounts.triplets):
        name = triplet.edit.name
        if name not in drawn:
            drawn.add(name)
            file = f"edit-{name.replace(' + ', ' ').replace(' ', '-')}.png"
            write_atomically(folder / file, png_bytes(edit_picture(codecs, triplet)))


# --- Picture to pattern --------------------------------------------------------------------------


def _run_image(options: argparse.Namespace) -> Exit:
    from garmentimage.dataset import dataset_hash, read_summary
    from garmentimage.evaluate import (
        ImageAmounts,
        evaluate_images,
        group_by_held_out,
        held_out_table,
        image_table,
        predictors_from_names,
        with_baselines,
    )

    if options.data is None and options.recipe is None:
        raise LearnError("name a dataset with --data, or a recipe with --recipe")
    data = options.data or Path("data") / options.recipe
    recipe = read_summary(data)["recipe"]
    if options.recipe not in (None, recipe):
        raise LearnError(f"{shown_path(data)}: is of recipe {recipe}, not {quoted(options.recipe)}")
    amounts = ImageAmounts(**_amounts(options, IMAGE, 0))
    validation = bool(options.validation)
    runs = options.network or _runs(recipe)
    if not runs:
        raise LearnError(
            f"there are no networks runs/{recipe}-*/model; train some, or name them with --network"
        )
    tables: list[str] = []
    results: dict[str, Any] = {}
    for held_out, guessers in group_by_held_out(
        predictors_from_names(runs), data, validation=validation
    ).items():
        folder = options.out / _folder(held_out) if held_out else options.out
        every = with_baselines(guessers)
        with _Bar() as bar:
            told = evaluate_images(
                every,
                data,
                folder,
                amounts,
                held_out=held_out,
                validation=validation,
                workers=options.workers,
                progress=bar.at,
            )
        results[held_out] = told | {"networks": _facts(guessers)}
        tables.append(f"{held_out}\n\n{image_table(told['figures'])}".lstrip())
        if not validation:
            _draw_guesses(folder, every, str(data), held_out, amounts)
    if len(results) > 1:
        by_type = {held_out: told["figures"] for held_out, told in results.items()}
        tables.insert(0, held_out_table(by_type))
    whole: dict[str, Any] = results.get("", {"held out": results})
    result = {
        **_provenance(recipe),
        "data_sha256": dataset_hash(data),
        "split": "validation" if validation else "test",
        "amounts": vars(amounts),
        **whole,
    }
    _put(options.out, result, "\n".join(tables))
    return _say(options, options.out, result, "\n".join(tables))


def _runs(recipe: str) -> list[str]:
    """Finished runs of a recipe; those that differ by a number at the end differ in their seed."""
    found = []
    for model in sorted(Path("runs").glob(f"{recipe}-*/model")):
        name = model.parent.name.removeprefix(f"{recipe}-")
        stem, _, last = name.rpartition("-")
        found.append(f"{stem if last.isdigit() and stem else name}={model}")
    return found


def _folder(held_out: str) -> str:
    from garmentimage.system import safe_name

    return safe_name(held_out)


def _facts(guessers: Sequence["Predictor"]) -> list[dict[str, Any]]:
    """Of each network its folder, and the facts of its run."""
    from garmentimage.evaluate import read_run

    told: list[dict[str, Any]] = []
    for guesser in guessers:
        run = read_run(guesser)
        told.append({"name": guesser.name, "folder": guesser.folder})
        told[-1] |= {key: run[key] for key in OF_RUN if key in run}
    return told


def _draw_guesses(
    folder: Path, guessers: Sequence["Predictor"], data: str, held_out: str, amounts: "ImageAmounts"
) -> None:
    """Some of what is measured, of each split and of all types; one cascade guesses."""
    from garmentimage.evaluate import (
        SPLIT_NAMES,
        TEACHER_STAGES,
        has_unseen,
        load_garments,
        measuring_order,
        predictions_picture,
    )
    from garmentimage.render import png_bytes

    chosen: dict[str, Predictor] = {}
    for guesser in guessers:
        if guesser.level == "full" and guesser.kind not in (*TEACHER_STAGES, "random"):
            key = guesser.kind if guesser.kind == "cascade" else guesser.name
            chosen.setdefault(key, guesser)
    for split, name in SPLIT_NAMES.items():
        if split == "unseen" and not has_unseen(data, held_out):
            continue
        album, _ = load_garments(data, split, held_out)
        measured = measuring_order(album)[: amounts.of(split)]
        # Types in turn: of each the first, then of each the second, and so on.
        seen: Counter[str] = Counter()
        turns = []
        for number in measured:
            turns.append((seen[album.types[number]], number))
            seen[album.types[number]] += 1
        numbers = [number for _, number in sorted(turns, key=lambda turn: turn[0])[:SHOWN]]
        if numbers:
            drawn = predictions_picture(list(chosen.values()), data, held_out, album, numbers)
            write_atomically(folder / f"{name}.png", png_bytes(drawn))


# --- Editing by text -----------------------------------------------------------------------------


def _run_edit(options: argparse.Namespace) -> Exit:
    from garmentimage.dataset import dataset_hash, read_summary
    from garmentimage.evaluate import evaluate_text_edits, text_edits_picture, text_table
    from garmentimage.render import png_bytes

    if options.data is None:
        raise LearnError("name the dataset of the networks with --data")
    if (options.vectors is None) != (options.vector_pictures is None):
        raise LearnError("give --vectors and --vector-pictures together, or neither")
    recipe = read_summary(options.data)["recipe"]
    editors = _editors(options)
    count = _amounts(options, EDIT, 1)["edited"]
    validation = bool(options.validation)
    with _Bar() as bar:
        figures = evaluate_text_edits(
            editors,
            options.data,
            options.out,
            count,
            validation=validation,
            workers=options.workers,
            progress=bar.at,
        )
    result = {
        **_provenance(recipe),
        "data_sha256": dataset_hash(options.data),
        "split": "validation" if validation else "test",
        "garments": count,
        "editors": [_named(each) for each in editors],
        "figures": figures,
    }
    _put(options.out, result, text_table(figures))
    drawn = text_edits_picture(editors, "validation" if validation else "test")
    write_atomically(options.out / "edits.png", png_bytes(drawn))
    return _say(options, options.out, result, text_table(figures))


def _editors(options: argparse.Namespace) -> list["EditMethod"]:
    from garmentimage.evaluate import EditMethod
    from garmentimage.latent import LatentSpace
    from garmentimage.networks import network_folder
    from garmentimage.text_edit import (
        DEFAULT_DENOISER,
        DEFAULT_IMAGE_DECODER,
        DEFAULT_SPACE,
        DEFAULT_STEPS,
        MAX_ATTEMPTS,
        check_options,
        denoiser_names,
        image_decoder_names,
    )

    pictures = network_folder(
        options.pictures or DEFAULT_IMAGE_DECODER, image_decoder_names(), "picture network"
    )
    denoiser = network_folder(options.denoiser or DEFAULT_DENOISER, denoiser_names(), "denoiser")
    space = LatentSpace.load(options.space or DEFAULT_SPACE).folder
    steps = DEFAULT_STEPS if options.steps is None else options.steps
    strength = 1.0 if options.strength is None else options.strength
    tries = MAX_ATTEMPTS if options.tries is None else options.tries
    check_options(strength, steps, tries)
    common: dict[str, Any] = {
        "data": str(options.data), "denoiser": str(denoiser), "strength": strength, "steps": steps,
        "tries": tries,
    }  # fmt: skip
    found = [
        EditMethod("small guidance", "raster", space=str(space), pictures=str(pictures), **common)
    ]
    if options.vectors is not None:
        found.append(
            EditMethod(
                "vectors, small guidance",
                "vectors",
                space=options.vectors,
                pictures=options.vector_pictures,
                **common,
            )
        )
    return [
        *found,
        EditMethod("no guidance", "nothing", str(options.data), str(space)),
        EditMethod("nearest caption", "caption", str(options.data)),
    ]


def _named(editing: "EditMethod") -> dict[str, Any]:
    """An editor for a result: networks that come with the package by name, not by place."""
    from garmentimage.networks import WEIGHTS_FOLDER

    return {
        name: Path(value).name if value and Path(str(value)).parent == WEIGHTS_FOLDER else value
        for name, value in vars(editing).items()
    }


# --- What they share -----------------------------------------------------------------------------


def _provenance(recipe: str) -> dict[str, str]:
    from garmentimage.system import source_commit

    return {
        "recipe": recipe,
        "commit": source_commit(),
        "date": datetime.now(UTC).date().isoformat(),
    }


def _put(folder: Path, result: dict[str, Any], table: str) -> None:
    write_atomically(folder / "result.json", json.dumps(result, indent=1) + "\n")
    write_atomically(folder / "table.md", table)


def _say(options: argparse.Namespace, folder: Path, result: dict[str, Any], table: str) -> Exit:
    if options.json:
        print_json(result)
    else:
        print(table)
        print(f"{shown_path(folder)}: records, result.json, table.md and figures")
    return Exit.OK


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
