"""The verb of the command line that trains networks: train."""

import argparse
import json
import shlex
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import Exit, list_facts, print_json, whole_number
from garmentimage.errors import LearnError, quoted
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from garmentimage.learn import TrainingSettings

BASELINES = ("panel-transformer", "panel-recurrent", "panel-pool")
NETWORKS = ("vae", "vector-vae", "cascade", *BASELINES, "image-decoder", "denoiser")
DEPARTURES = (
    "losses",
    "noise",
    "weights",
    "shares",
    "mirror",
    "dropout",
    "recombine",
    "recolour",
)
EVERYTHING = "all"
ACCELERATORS = ("cpu", "gpu", "cuda", "mps", "auto")
OF_SETTINGS = ("epochs", "batch", "rate", "seed", "accelerator", "devices", "nodes", "precision")
ONLY_OF = {
    "beta": ("vae", "vector-vae"),
    "without": ("cascade", *BASELINES),
    "as_paper": ("cascade",),
    "resnet": BASELINES,
    "vae": ("image-decoder",),
}
"""Options that not all networks have."""
MOST_BETA = 1000.0
PRECISIONS = ("auto", "32-true", "bf16-mixed", "16-mixed")


def train_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `train`."""
    parser.add_argument("network", metavar="NETWORK", help=" or ".join(NETWORKS))
    parser.add_argument(
        "--data", type=Path, required=True, metavar="FOLDER", help="what `build` wrote"
    )
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="RUN", help="a folder; gone on with"
    )
    parser.add_argument("--epochs", type=whole_number, metavar="N", help="times through the data")
    parser.add_argument("--batch", type=whole_number, metavar="N", help="garments a step (64)")
    parser.add_argument("--rate", type=float, metavar="X", help="highest learning rate (0.002)")
    parser.add_argument("--beta", type=float, metavar="X", help="weight of the prior")
    parser.add_argument("--seed", type=whole_number, metavar="N")
    parser.add_argument(
        "--without", action="append", default=[], metavar="TYPE", help="leave a type out"
    )
    parser.add_argument(
        "--as-paper",
        action="append",
        default=[],
        metavar="PART",
        help=f"cascade: {', '.join(DEPARTURES)} or {EVERYTHING}, as in the paper",
    )
    parser.add_argument(
        "--resnet", type=Path, metavar="FOLDER", help="baselines: ResNet that sees, pretrained"
    )
    parser.add_argument(
        "--vae", type=Path, metavar="FOLDER", help="image-decoder: the trained VAE that it follows"
    )
    parser.add_argument("--accelerator", metavar="KIND", help=", ".join(ACCELERATORS))
    parser.add_argument("--devices", type=whole_number, metavar="N", help="on each node (1)")
    parser.add_argument("--nodes", type=whole_number, metavar="N", help="machines (1)")
    parser.add_argument("--precision", metavar="P", help=", ".join(PRECISIONS))


def run_train(options: argparse.Namespace) -> Exit:
    """Train a network, or go on with it."""
    if options.network not in NETWORKS:
        raise LearnError(f"there is no network {options.network!r}; choose {' or '.join(NETWORKS)}")
    _need_extra()
    settings = _settings(options)
    import torch

    from garmentimage.learn import MODEL_FOLDER, TaskOptions, model_card, task_for, train

    parts = tuple(DEPARTURES) if EVERYTHING in options.as_paper else tuple(options.as_paper)
    task = task_for(
        options.network,
        TaskOptions(
            data=options.data,
            beta=options.beta,
            without=tuple(options.without),
            ablate=parts,
            resnet=options.resnet,
            vae=options.vae,
        ),
    )
    torch.manual_seed(settings.seed)
    facts = {"network": options.network, "config": asdict(task.config), **task.facts}
    with _Bar(settings.epochs) as bar:
        trained = train(
            task.build(),
            task.train_set,
            task.held_out,
            folder=options.out,
            settings=settings,
            facts={**facts, **_data_facts(options.data)},
            progress=bar.line,
        )
    told = _told(options, settings, trained.log, len(task.train_set))
    of_data = {"recipe": told["recipe"], "seed": told["seed of the data"]}
    title = f"{task.title}, {told['recipe']}"
    text = model_card(title, task.summary, task.usage, told, trained.log[-1])
    task.save(trained.model, of_data, text, options.out / MODEL_FOLDER)
    return _say(options, told, trained.log[-1])


class _Bar:
    """Progress by epoch, with the losses."""

    def __init__(self, epochs: int) -> None:
        from tqdm import tqdm

        self.bar = tqdm(total=epochs, unit="epoch", disable=None, file=sys.stderr)

    def __enter__(self) -> "_Bar":
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.close()

    def line(self, told: dict[str, float]) -> None:
        """After every epoch."""
        self.bar.n = int(told["epoch"])
        self.bar.set_postfix(
            {"loss": f"{told['loss']:.4f}", "held out": f"{told['held-out loss']:.4f}"}
        )


def _settings(options: argparse.Namespace) -> "TrainingSettings":
    from garmentimage.learn import TrainingSettings

    given = {name: getattr(options, name) for name in OF_SETTINGS}
    for name, known in (("accelerator", ACCELERATORS), ("precision", PRECISIONS)):
        if given[name] not in (None, *known):
            raise LearnError(f"there is no {name} {quoted(given[name])}; choose {', '.join(known)}")
    settings = TrainingSettings(**{k: value for k, value in given.items() if value is not None})
    if options.beta is not None and not 0 <= options.beta <= MOST_BETA:
        raise LearnError(f"--beta is {options.beta}; give 0 to {MOST_BETA:g}")
    for name, networks in ONLY_OF.items():
        if getattr(options, name) not in (None, []) and options.network not in networks:
            raise LearnError(f"--{name.replace('_', '-')} is for {', '.join(networks)} only")
    for part in options.as_paper:
        if part not in (*DEPARTURES, EVERYTHING):
            raise LearnError(
                f"--as-paper is {quoted(part)}; choose {', '.join(DEPARTURES)} or {EVERYTHING}"
            )
    return settings


def _data_facts(folder: Path) -> dict[str, Any]:
    from garmentimage.dataset import dataset_hash, read_summary

    summary = read_summary(folder)
    names = ("recipe", "version", "count", "seed", "grid")
    return {
        "data": {name: summary.get(name) for name in names}, "data_sha256": dataset_hash(folder)
    }  # fmt: skip


def _told(
    options: argparse.Namespace,
    settings: "TrainingSettings",
    log: tuple[dict[str, float], ...],
    count: int,
) -> dict[str, Any]:
    from garmentimage.dataset import dataset_hash, read_summary
    from garmentimage.learn import RUN_FILE

    summary = read_summary(options.data)
    run = json.loads((options.out / RUN_FILE).read_text(encoding="utf-8"))
    return {
        "recipe": summary["recipe"],
        "garments trained on": count,
        "seed of the data": summary["seed"],
        "data": f"SHA-256 {dataset_hash(options.data)}",
        "epochs": settings.epochs,
        "seed": settings.seed,
        "minutes": round(sum(line["seconds"] for line in log) / 60, 1),
        "command": _command(options),
        "commit": run["commit"],
        "versions": ", ".join(run["versions"]),
    }


def _command(options: argparse.Namespace) -> str:
    """What trains the same network again."""
    names = (*OF_SETTINGS, "beta", "resnet", "vae")
    given = [(name, getattr(options, name)) for name in names]
    given += [(n, each) for n in ("without", "as_paper") for each in getattr(options, n)]
    words = [
        shlex.join([f"--{name.replace('_', '-')}", str(value)])
        for name, value in given
        if value is not None
    ]
    start = f"garmentimage train {options.network} --data {options.data}"
    return " ".join([start, *words, "-o", str(options.out)])


def _say(options: argparse.Namespace, told: dict[str, Any], last: dict[str, float]) -> Exit:
    if options.json:
        print_json({"out": str(options.out), **told, "log": last})
        return Exit.OK
    short = {key: told[key] for key in ("recipe", "garments trained on", "epochs", "minutes")}
    print(f"{shown_path(options.out)}: trained, {list_facts(short)}")
    print(f"{shown_path(options.out / 'model')}: the network; curves.png: its losses")
    return Exit.OK


def _need_extra() -> None:
    from importlib.util import find_spec

    for name in ("torch", "lightning_fabric", "safetensors", "pyarrow"):
        if find_spec(name) is None:
            raise LearnError(f"training needs {name}; install it with `pip install -e '.[learn]'`")
