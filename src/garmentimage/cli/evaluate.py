"""The verb that measures networks: evaluate, with a verb of its own for each subject."""

import json as json_module
from collections.abc import Callable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Group, Parameter

from garmentimage.cli.options import Json, OutFolder, Space, Whole, within
from garmentimage.cli.terminal import Progress, print_json
from garmentimage.cli.usage import group_of_verbs
from garmentimage.errors import LearnError, quoted
from garmentimage.evaluate import ImageAmounts, LatentAmounts
from garmentimage.system import safe_name, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.evaluate import Candidate, EditMethod, Predictor

RUN_FACTS = ("network", "settings", "config", "without")
LATENT_AMOUNTS, IMAGE_AMOUNTS = LatentAmounts(), ImageAmounts()

Data = Annotated[
    Path, Parameter(metavar="FOLDER", help="The dataset that the networks were trained on.")
]
Amounts = Parameter(name="*", group=Group("Amounts", sort_key=1))
Workers = Annotated[Whole, Parameter(validator=within(1), help="Processes.")]
Validation = Annotated[
    bool,
    Parameter(
        help="Measure on the validation split, to make choices by; unseen are the types that "
        "`train --without` left out."
    ),
]
Network = Annotated[str, Parameter(metavar="NAME")]


evaluate = group_of_verbs(
    "evaluate",
    "Measure networks on held-out garments.\n\n"
    "Options of each subject: `garmentimage evaluate SUBJECT --help`.",
    "Subjects",
)


# --- latent --------------------------------------------------------------------------------------


@evaluate.command
def latent(
    *,
    data: Data,
    out: OutFolder,
    vae: Annotated[str | None, Parameter(metavar="NAME")] = None,
    vectors: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    amounts: Annotated[LatentAmounts, Amounts] = LATENT_AMOUNTS,
    workers: Workers = 2,
    json: Json = False,
) -> None:
    """Measure latent spaces: reconstruction, interpolation and edits.

    Args:
        vae: A bundled latent space, or its folder.
        vectors: Folder of a vector VAE of that dataset.
    """
    from garmentimage.dataset import read_summary
    from garmentimage.evaluate import EDITS, draw_latent_figures, evaluate_latent, latent_table

    recipe = read_summary(data)["recipe"]
    if recipe not in EDITS:
        raise LearnError(
            f"{shown_path(data)}: is of recipe {recipe}; latent spaces are measured on "
            f"{', '.join(EDITS)}"
        )
    networks = _candidates(data, vae, vectors)
    with Progress("garment") as progress:
        figures = evaluate_latent(
            networks, recipe, out, amounts, workers=workers, progress=progress.at
        )
    result = {
        **_provenance(recipe, data),
        "networks": [_named(each) for each in networks],
        "amounts": asdict(amounts),
        "figures": figures,
    }
    _write(out, result, latent_table(figures), as_json=json)
    draw_latent_figures(out, networks, recipe, amounts)


def _candidates(data: Path, vae: str | None, vectors: Path | None) -> list["Candidate"]:
    from garmentimage.evaluate import Candidate
    from garmentimage.latent import LatentSpace
    from garmentimage.raster.repair import LEVELS

    networks: list[Candidate] = []
    if vae is not None:
        folder = str(LatentSpace.load(vae).folder)
        networks += [Candidate(f"raster, {level}", folder, str(data), level) for level in LEVELS]
    if vectors is not None:
        if not (vectors / "model.safetensors").is_file():
            raise LearnError(f"{shown_path(vectors)}: holds no network")
        networks.append(Candidate("vectors", str(vectors), str(data), None))
    if not networks:
        raise LearnError("name a network with --vae or --vectors")
    return [*networks, Candidate("no network", "", str(data), "full")]


# --- image ---------------------------------------------------------------------------------------


@evaluate.command
def image(
    *,
    out: OutFolder,
    data: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    recipe: str | None = None,
    network: Annotated[tuple[str, ...], Parameter(metavar="NAME=RUN", show_default=False)] = (),
    amounts: Annotated[ImageAmounts, Amounts] = IMAGE_AMOUNTS,
    validation: Validation = False,
    workers: Workers = 2,
    json: Json = False,
) -> None:
    """Measure networks that predict patterns from pictures.

    Args:
        data: The dataset of the networks; without it, data/RECIPE.
        recipe: Recipe of the dataset data/RECIPE and of the networks runs/RECIPE-*.
        network: A network instead of runs/RECIPE-*; may be repeated, with one NAME for networks
            that differ only in their seed.
    """
    from garmentimage.evaluate import (
        draw_prediction_figures,
        evaluate_images,
        group_by_held_out,
        held_out_table,
        image_table,
        predictors_from_names,
        with_baselines,
    )

    folder, found = _image_data(data, recipe)
    runs = list(network) or _runs(found)
    if not runs:
        raise LearnError(
            f"there are no networks runs/{found}-*/model; train some, or name them with --network"
        )
    predictors = predictors_from_names(runs)
    tables: list[str] = []
    results: dict[str, Any] = {}
    for held_out, group in group_by_held_out(predictors, folder, validation=validation).items():
        place = out / safe_name(held_out) if held_out else out
        every = with_baselines(group)
        with Progress("garment") as progress:
            measured = evaluate_images(
                every,
                folder,
                place,
                amounts,
                held_out=held_out,
                validation=validation,
                workers=workers,
                progress=progress.at,
            )
        results[held_out] = measured | {"networks": _run_facts(group)}
        tables.append(f"{held_out}\n\n{image_table(measured['figures'])}".lstrip())
        if not validation:
            draw_prediction_figures(place, every, str(folder), held_out, amounts)
    if len(results) > 1:
        by_type = {held_out: measured["figures"] for held_out, measured in results.items()}
        tables.insert(0, held_out_table(by_type))
    whole: dict[str, Any] = results.get("", {"held out": results})
    result = {
        **_provenance(found, folder),
        "split": "validation" if validation else "test",
        "amounts": vars(amounts),
        **whole,
    }
    _write(out, result, "\n".join(tables), as_json=json)


def _image_data(data: Path | None, recipe: str | None) -> tuple[Path, str]:
    """The dataset that is named, or that of the recipe, and its recipe."""
    from garmentimage.dataset import read_summary

    if data is None and recipe is None:
        raise LearnError("name a dataset with --data, or a recipe with --recipe")
    folder = data or Path("data") / str(recipe)
    found: str = read_summary(folder)["recipe"]
    if recipe not in (None, found):
        raise LearnError(f"{shown_path(folder)}: is of recipe {found}, not {quoted(str(recipe))}")
    return folder, found


def _runs(recipe: str) -> list[str]:
    """Finished runs of a recipe; those that differ by a number at the end differ in their seed."""
    found = []
    for model in sorted(Path("runs").glob(f"{recipe}-*/model")):
        name = model.parent.name.removeprefix(f"{recipe}-")
        stem, _, last = name.rpartition("-")
        found.append(f"{stem if last.isdigit() and stem else name}={model}")
    return found


def _run_facts(predictors: Sequence["Predictor"]) -> list[dict[str, Any]]:
    """Of each network its folder, and the facts of its run."""
    from garmentimage.evaluate import read_run

    return [
        {"name": each.name, "folder": each.folder, **{k: run[k] for k in RUN_FACTS if k in run}}
        for each, run in zip(predictors, map(read_run, predictors), strict=True)
    ]


# --- text ----------------------------------------------------------------------------------------


@evaluate.command
def text(
    *,
    data: Data,
    out: OutFolder,
    space: Space = "text-edit",
    image_decoder: Network = "text-edit-pictures",
    denoiser: Network = "text-edit-denoiser",
    vectors: Annotated[str | None, Parameter(metavar="FOLDER")] = None,
    vector_image_decoder: Annotated[str | None, Parameter(metavar="FOLDER")] = None,
    strength: float = 1.0,
    steps: Whole = 60,
    attempts: Whole = 4,
    garments: Annotated[Whole, Parameter(validator=within(1), group=Amounts.group)] = 24,
    validation: Validation = False,
    workers: Workers = 2,
    json: Json = False,
) -> None:
    """Measure edits by text.

    Args:
        image_decoder: A bundled network that decodes pictures from the latent space, or its folder.
        denoiser: A bundled network that guides the edits, or its folder.
        vectors: Folder of a vector VAE of that dataset, for comparison.
        vector_image_decoder: Folder of the image decoder of that vector VAE.
        strength: How far garments may change.
        steps: Steps of each attempt.
        attempts: How often a result is checked and the edit repeated, at most.
        garments: Garments that are edited.
    """
    from garmentimage.dataset import read_summary
    from garmentimage.evaluate import draw_text_edits, evaluate_text_edits, text_edits_table
    from garmentimage.text_edit import check_options

    if (vectors is None) != (vector_image_decoder is None):
        raise LearnError("give --vectors and --vector-image-decoder together, or neither")
    recipe = read_summary(data)["recipe"]
    check_options(strength, steps, attempts)
    methods = _edit_methods(
        space,
        image_decoder,
        denoiser,
        (vectors, vector_image_decoder) if vectors and vector_image_decoder else (),
        data=str(data),
        strength=strength,
        steps=steps,
        tries=attempts,
    )
    split = "validation" if validation else "test"
    with Progress("garment") as progress:
        figures = evaluate_text_edits(
            methods,
            data,
            out,
            garments,
            validation=validation,
            workers=workers,
            progress=progress.at,
        )
    result = {
        **_provenance(recipe, data),
        "split": split,
        "garments": garments,
        "editors": [_named(each) for each in methods],
        "figures": figures,
    }
    draw_text_edits(out, methods, split)
    _write(out, result, text_edits_table(figures), as_json=json)


def _edit_methods(
    space: str,
    image_decoder: str,
    denoiser: str,
    vector_networks: Sequence[str],
    **common: Any,
) -> list["EditMethod"]:
    """Edits with the small guidance, and baselines: vectors, no guidance, the nearest caption."""
    from garmentimage.evaluate import EditMethod
    from garmentimage.latent import LatentSpace
    from garmentimage.networks import network_folder
    from garmentimage.text_edit import denoiser_names, image_decoder_names

    pictures = str(network_folder(image_decoder, image_decoder_names(), "picture network"))
    guide = str(network_folder(denoiser, denoiser_names(), "denoiser"))
    folder = str(LatentSpace.load(space).folder)
    guided: Callable[..., EditMethod] = partial(EditMethod, denoiser=guide, **common)
    methods = [guided("small guidance", "raster", space=folder, pictures=pictures)]
    if vector_networks:
        latents, decoder = vector_networks
        methods.append(
            guided("vectors, small guidance", "vectors", space=latents, pictures=decoder)
        )
    return [
        *methods,
        EditMethod("no guidance", "nothing", common["data"], folder),
        EditMethod("nearest caption", "caption", common["data"]),
    ]


def _named(method: "Candidate | EditMethod") -> dict[str, Any]:
    """A network or method for a result: bundled networks by name, not by place."""
    from garmentimage.networks import WEIGHTS_FOLDER

    return {
        name: Path(value).name if value and Path(str(value)).parent == WEIGHTS_FOLDER else value
        for name, value in vars(method).items()
    }


# --- Shared --------------------------------------------------------------------------------------


def _provenance(recipe: str, data: Path) -> dict[str, str]:
    from garmentimage.dataset import dataset_hash
    from garmentimage.system import source_commit

    return {
        "recipe": recipe,
        "commit": source_commit(),
        "date": datetime.now(UTC).date().isoformat(),
        "data_sha256": dataset_hash(data),
    }


def _write(folder: Path, result: dict[str, Any], table: str, *, as_json: bool) -> None:
    write_atomically(folder / "result.json", json_module.dumps(result, indent=1) + "\n")
    write_atomically(folder / "table.md", table)
    if as_json:
        print_json(result)
    else:
        print(table)
        print(f"{shown_path(folder)}: records, result.json, table.md and figures")
