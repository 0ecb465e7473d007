"""The verb that trains networks: train, with a verb of its own for each network."""

import json as json_module
import shlex
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from cyclopts import Group, Parameter

from garmentimage.cli.options import Json, need_libraries, within
from garmentimage.cli.terminal import Progress, list_facts, print_json
from garmentimage.cli.usage import group_of_verbs
from garmentimage.learn import TrainingSettings
from garmentimage.system import shown_path

Baseline = Literal["panel-transformer", "panel-recurrent", "panel-pool"]
Ablation = Literal[
    "losses", "noise", "weights", "shares", "mirror", "dropout", "recombine", "recolour"
]
EVERYTHING = "all"
BASELINES: tuple[Baseline, ...] = get_args(Baseline)
ABLATIONS: tuple[Ablation, ...] = get_args(Ablation)
MAX_BETA = 1000.0
LIBRARIES = ("torch", "lightning_fabric", "safetensors", "pyarrow")
DATA_FACTS = ("recipe", "version", "count", "seed", "grid")
SETTINGS = TrainingSettings()
"""The defaults."""

Settings = Annotated[TrainingSettings, Parameter(name="*", group=Group("Training", sort_key=1))]
Beta = Annotated[
    float | None,
    Parameter(
        validator=within(0, MAX_BETA), help="Weight of the prior; without it, the network's own."
    ),
]
Without = Annotated[
    tuple[str, ...],
    Parameter(metavar="TYPE", show_default=False, help="Leave out a type; may be repeated."),
]


@Parameter(name="*")
@dataclass(frozen=True)
class RunOptions:
    """Where a network learns from, and where it is kept."""

    data: Annotated[Path, Parameter(metavar="FOLDER")]
    """A dataset that `build` wrote."""
    out: Annotated[Path, Parameter(name=("--out", "-o"), metavar="RUN")]
    """Folder of the run; an interrupted one is resumed."""


train = group_of_verbs(
    "train",
    "Train a network on a dataset, or resume its training.\n\n"
    "Options of each network: `garmentimage train NETWORK --help`.",
    "Networks",
)


@train.command
def vae(
    *,
    run: RunOptions,
    beta: Beta = None,
    contract: Annotated[Literal[1, 2] | None, Parameter(show_default=False)] = None,
    layers: Annotated[Literal[2, 4] | None, Parameter(show_default=False)] = None,
    settings: Settings = SETTINGS,
    json: Json = False,
) -> None:
    """Train the VAE of GarmentImages.

    Args:
        contract: Channel contract of its images: 2 for garments with panels that wrap round or are
            turned, with pockets or pleats. Without it, 1.
        layers: Layers of its images: 4 for garments with cloth on cloth, with contract 2. Without
            it, 2.
    """
    _train("vae", run, settings, as_json=json, beta=beta, contract=contract, layers=layers)


@train.command
def vector_vae(
    *, run: RunOptions, beta: Beta = None, settings: Settings = SETTINGS, json: Json = False
) -> None:
    """Train the vector-based baseline of the VAE."""
    _train("vector-vae", run, settings, as_json=json, beta=beta)


@train.command
def cascade(
    *,
    run: RunOptions,
    without: Without = (),
    ablate: Annotated[tuple[Ablation | Literal["all"], ...], Parameter(show_default=False)] = (),
    settings: Settings = SETTINGS,
    json: Json = False,
) -> None:
    """Train the cascade that predicts GarmentImages from pictures.

    Args:
        ablate: Leave out one of our departures from the paper, or all; may be repeated.
    """
    parts = ABLATIONS if EVERYTHING in ablate else ablate
    _train("cascade", run, settings, as_json=json, without=without, ablate=parts)


def _baseline(name: Baseline, summary: str) -> Callable[..., None]:
    def baseline(
        *,
        run: RunOptions,
        without: Without = (),
        resnet: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
        settings: Settings = SETTINGS,
        json: Json = False,
    ) -> None:
        """Train a vector-based baseline of the cascade.

        Args:
            resnet: Folder of a pretrained ResNet that encodes the pictures.
        """
        _train(name, run, settings, as_json=json, without=without, resnet=resnet)

    baseline.__doc__ = (baseline.__doc__ or "").replace("a vector-based baseline", summary)
    return baseline


for _name, _summary in {
    "panel-transformer": "the transformer over panels, a vector-based baseline",
    "panel-recurrent": "the recurrent network over panels, a vector-based baseline",
    "panel-pool": "the network with a pool of panels, a vector-based baseline",
}.items():
    train.command(_baseline(_name, _summary), name=_name)  # type: ignore[arg-type]


@train.command
def image_decoder(
    *,
    run: RunOptions,
    vae: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    settings: Settings = SETTINGS,
    json: Json = False,
) -> None:
    """Train the decoder of latent vectors to pictures.

    Args:
        vae: Folder of the trained VAE whose latent vectors it decodes.
    """
    _train("image-decoder", run, settings, as_json=json, vae=vae)


@train.command
def denoiser(*, run: RunOptions, settings: Settings = SETTINGS, json: Json = False) -> None:
    """Train the denoiser that guides edits by text."""
    _train("denoiser", run, settings, as_json=json)


def _train(
    network: str, run: RunOptions, settings: TrainingSettings, *, as_json: bool, **options: Any
) -> None:
    """Train a network, or resume its training, and keep it with its card."""
    need_libraries("training", LIBRARIES, "learn")
    import torch

    from garmentimage.dataset import dataset_hash, read_summary
    from garmentimage.learn import (
        MODEL_FOLDER,
        RUN_FILE,
        TaskOptions,
        model_card,
        task_for,
        train as train_network,
    )

    task = task_for(network, TaskOptions(data=run.data, **options))
    torch.manual_seed(settings.seed)
    summary, data_sha256 = read_summary(run.data), dataset_hash(run.data)
    facts = {
        "network": network,
        "config": asdict(task.config),
        **task.facts,
        "data": {name: summary.get(name) for name in DATA_FACTS},
        "data_sha256": data_sha256,
    }
    with Progress("epoch", settings.epochs) as progress:

        def report(line: dict[str, float]) -> None:
            progress.at(int(line["epoch"]), settings.epochs)
            progress.show(
                {"loss": f"{line['loss']:.4f}", "held out": f"{line['held-out loss']:.4f}"}
            )

        trained = train_network(
            task.build(),
            task.train_set,
            task.held_out,
            folder=run.out,
            settings=settings,
            facts=facts,
            progress=report,
        )
    written = json_module.loads((run.out / RUN_FILE).read_text(encoding="utf-8"))
    card = {
        "recipe": summary["recipe"],
        "garments trained on": len(task.train_set),
        "seed of the data": summary["seed"],
        "data": f"SHA-256 {data_sha256}",
        "epochs": settings.epochs,
        "seed": settings.seed,
        "minutes": round(sum(line["seconds"] for line in trained.log) / 60, 1),
        "command": _command(network, run, settings, options),
        "commit": written["commit"],
        "versions": ", ".join(written["versions"]),
    }
    of_data = {"recipe": summary["recipe"], "seed": summary["seed"]}
    title = f"{task.title}, {summary['recipe']}"
    text = model_card(title, task.summary, task.usage, card, trained.log[-1])
    task.save(trained.model, of_data, text, run.out / MODEL_FOLDER)
    if as_json:
        print_json({"out": str(run.out), **card, "log": trained.log[-1]})
        return
    short = {key: card[key] for key in ("recipe", "garments trained on", "epochs", "minutes")}
    print(f"{shown_path(run.out)}: trained, {list_facts(short)}")
    print(f"{shown_path(run.out / MODEL_FOLDER)}: the network; curves.png: its losses")


def _command(
    network: str, run: RunOptions, settings: TrainingSettings, options: dict[str, Any]
) -> str:
    """The command that trains the same network again: all that differs from the defaults."""
    words = ["garmentimage", "train", network, "--data", str(run.data)]
    for each in fields(settings):
        value = getattr(settings, each.name)
        if value != each.default:
            words += [f"--{each.name}", str(value)]
    for name, value in options.items():
        for one in value if isinstance(value, tuple) else (value,):
            if one is not None:
                words += [f"--{name.replace('_', '-')}", str(one)]
    return shlex.join([*words, "-o", str(run.out)])
