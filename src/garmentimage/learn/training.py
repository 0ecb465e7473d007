"""Training: one loop for every network, resumed where it was stopped, the same for one seed.

A run is a folder: `run.json` (settings, commit, data), `checkpoint.ckpt` (rewritten after every
epoch), `log.jsonl` (a line an epoch), `tensorboard/`, `curves.png`, and at the end `model/`, the
averaged weights.
"""

import copy
import json
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import torch
from lightning_fabric import Fabric
from torch import Tensor, nn

from garmentimage.errors import LearnError
from garmentimage.learn.settings import TrainingSettings
from garmentimage.system import shown_path, source_commit, versions, write_atomically

RUN_FILE, LOG_FILE, CHECKPOINT, CURVES = "run.json", "log.jsonl", "checkpoint.ckpt", "curves.png"
MODEL, BOARD = "model", "tensorboard"
WARM_UP = 0.02
"""Share of all steps in which the learning rate rises from 0."""
AVERAGE = 0.999
"""Of the averaged weights, what stays in a step."""


class Examples(Protocol):
    """What a network learns from, kept in memory."""

    def __len__(self) -> int: ...
    def batch(self, numbers: Tensor) -> Any:
        """Some of them, which have a method `to(device)`."""


@dataclass(frozen=True)
class Trained:
    """What came of a run."""

    model: nn.Module
    """With the averaged weights."""
    log: tuple[dict[str, float], ...]
    """Losses by epoch."""


def train(
    model: nn.Module,
    examples: Examples,
    held_out: Examples,
    folder: Path,
    settings: TrainingSettings,
    facts: Mapping[str, Any],
    progress: Callable[[dict[str, float]], None] = lambda line: None,
) -> Trained:
    """Train a network whose forward pass turns a batch into its losses, `loss` the whole of them.

    Args:
        model: the network, made anew from the same seed.
        examples: to learn from.
        held_out: to follow the losses on; nothing is chosen by them.
        folder: the run; gone on with where it is there.
        settings: how.
        facts: what else tells this run from another: model, sizes, data.
        progress: called after every epoch.

    Raises:
        LearnError: the folder holds another run, the accelerator is not there, or the loss is
            no number any more.
    """
    precision: Any = settings.precision
    if precision == "auto":
        precision = fitting_precision(settings.accelerator)
    try:
        fabric = Fabric(
            accelerator=settings.accelerator,
            devices=settings.devices,
            num_nodes=settings.nodes,
            precision=precision,  # type: ignore[arg-type]
        )
    except (RuntimeError, ValueError) as error:  # an accelerator that is not there
        raise LearnError(f"cannot train on this machine: {error}") from None
    _prepare(folder, {"settings": asdict(settings), **facts})
    fabric.launch()
    optimizer = torch.optim.AdamW(
        model.parameters(), settings.rate, weight_decay=settings.decay, betas=(0.9, 0.99)
    )
    average = copy.deepcopy(model)
    wrapped, optimizer = fabric.setup(model, optimizer)  # type: ignore[assignment]
    average.to(fabric.device)
    state = {"model": wrapped, "optimizer": optimizer, "average": average, "epoch": 0, "step": 0}
    if (folder / CHECKPOINT).exists():
        _resume(fabric, folder / CHECKPOINT, state)
    log = _read_log(folder, int(state["epoch"]))
    each = settings.batch * fabric.world_size
    steps = max(len(examples) // each, 1)
    board = _board(folder) if fabric.is_global_zero else None
    for epoch in range(int(state["epoch"]), settings.epochs):
        began = time.perf_counter()
        torch.manual_seed(settings.seed * 1_000_003 + epoch)
        order = torch.randperm(len(examples))
        torch.manual_seed(settings.seed * 1_000_003 + epoch + 500_009 * (1 + fabric.global_rank))
        wrapped.train()
        sums: dict[str, float] = {}
        for step in range(steps):
            first = step * each + fabric.global_rank * settings.batch
            batch = examples.batch(order[first : first + settings.batch]).to(fabric.device)
            rate = settings.rate * _schedule(int(state["step"]), settings.epochs * steps)
            for group in optimizer.param_groups:
                group["lr"] = rate
            losses = wrapped(batch)
            optimizer.zero_grad()
            fabric.backward(losses["loss"])
            fabric.clip_gradients(wrapped, optimizer, max_norm=1.0, error_if_nonfinite=False)
            optimizer.step()
            _follow(average, model, int(state["step"]))
            state["step"] = int(state["step"]) + 1
            for name, value in losses.items():
                sums[name] = sums.get(name, 0.0) + float(value.detach())
        line = {name: value / steps for name, value in sums.items()}
        line |= {f"held-out {k}": v for k, v in _held_out(average, held_out, settings).items()}
        if not math.isfinite(line["loss"]):
            raise LearnError(
                f"the loss is no number any more in epoch {epoch + 1}; choose another folder, and "
                "a lower learning rate, or look for numbers in the data that are none"
            )
        state["epoch"] = epoch + 1
        line |= {
            "epoch": epoch + 1,
            "seconds": round(time.perf_counter() - began, 2),
            "samples_a_second": round(steps * each / (time.perf_counter() - began), 1),
        }
        log.append(line)
        fabric.save(folder / f"{CHECKPOINT}.part", state)
        if fabric.is_global_zero:
            (folder / f"{CHECKPOINT}.part").replace(folder / CHECKPOINT)
        if board is not None:
            write_atomically(folder / LOG_FILE, "".join(json.dumps(each) + "\n" for each in log))
            for name, value in line.items():
                board.add_scalar(name.replace(" ", "/"), value, epoch + 1)
        progress(line)
    if board is not None:
        board.close()
        draw_curves(log, folder / CURVES)
    return Trained(average.cpu().eval(), tuple(log))


def fitting_precision(accelerator: str) -> str:
    """Mixed precision with bfloat16 where the hardware computes it, else full precision.

    Processors without it do it in software, ten times slower than in full precision.
    """
    if accelerator in ("gpu", "cuda", "auto") and torch.cuda.is_available():
        is_quick = torch.cuda.is_bf16_supported(including_emulation=False)
    elif accelerator in ("cpu", "auto"):
        # Older versions of torch do not tell.
        can: Mapping[str, Any] = getattr(torch.cpu, "get_capabilities", dict)()
        is_quick = any(can.get(name, False) for name in ("avx512_bf16", "amx_bf16", "bf16"))
    else:
        is_quick = False
    return "bf16-mixed" if is_quick else "32-true"


def _schedule(step: int, steps: int) -> float:
    """Share of the highest learning rate: a short rise, then half a cosine."""
    warm = max(WARM_UP * steps, 1)
    if step < warm:
        return (step + 1) / (warm + 1)
    return 0.5 * (1 + math.cos(math.pi * min((step - warm) / max(steps - warm, 1), 1)))


@torch.no_grad()
def _follow(average: nn.Module, model: nn.Module, step: int) -> None:
    """Move the averaged weights towards those of the model; quicker in the first steps."""
    keep = min(AVERAGE, (1 + step) / (10 + step))
    for ours, theirs in zip(average.parameters(), model.parameters()):
        ours.lerp_(theirs, 1 - keep)
    for buffer, other in zip(average.buffers(), model.buffers()):
        buffer.copy_(other)


@torch.no_grad()
def _held_out(model: nn.Module, examples: Examples, settings: TrainingSettings) -> dict[str, float]:
    model.eval()
    torch.manual_seed(settings.seed)
    sums: dict[str, float] = {}
    numbers = torch.arange(len(examples))
    device = next(model.parameters()).device
    for part in numbers.split(256):
        for name, value in model(examples.batch(part).to(device)).items():
            sums[name] = sums.get(name, 0.0) + float(value) * len(part) / len(numbers)
    return sums


def _resume(fabric: Fabric, file: Path, state: dict[str, Any]) -> None:
    """Take up what was trained before."""
    try:
        rest = fabric.load(file, state, weights_only=True)
        state |= {key: int(rest[key]) for key in ("epoch", "step") if key in rest}
    except Exception as error:  # What may go wrong spans three libraries.
        raise LearnError(
            f"{shown_path(file)}: is damaged, or of another network; remove the folder and train "
            "again"
        ) from error


def _prepare(folder: Path, wanted: dict[str, Any]) -> None:
    file = folder / RUN_FILE
    plain = json.loads(json.dumps(wanted))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, is_right in (
            (MODEL, Path.is_dir),
            (BOARD, Path.is_dir),
            (LOG_FILE, Path.is_file),
        ):
            if (folder / name).exists() and not is_right(folder / name):
                raise LearnError(f"{shown_path(folder / name)}: is in the way; remove it")
        if (folder / CHECKPOINT).exists() and not file.exists():
            raise LearnError(
                f"{shown_path(folder)}: holds a checkpoint of nobody knows what (there is no "
                f"{RUN_FILE}); choose another folder"
            )
        if file.exists():
            found = json.loads(file.read_text(encoding="utf-8"))
            found["commit"]
            if found["run"] != plain:
                names = [key for key in plain if found["run"].get(key) != plain[key]]
                raise LearnError(
                    f"{shown_path(folder)}: holds a run with other {', '.join(names)}; choose "
                    "another folder, or the settings in its run.json"
                )
            return
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, LearnError):
            raise
        raise LearnError(f"{shown_path(file)}: is damaged; choose another folder") from None
    except OSError as error:
        raise LearnError(
            f"{shown_path(folder)}: cannot be used ({error.strerror}); choose another folder"
        ) from None
    told = {"run": plain, "commit": source_commit(), "versions": versions("torch")}
    write_atomically(file, json.dumps(told, indent=1) + "\n")


def _read_log(folder: Path, epochs: int) -> list[dict[str, float]]:
    file = folder / LOG_FILE
    if not epochs:
        return []
    try:
        lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
        if len(lines) < epochs or not all("held-out loss" in line for line in lines):
            raise ValueError
    except (OSError, ValueError, TypeError):
        raise LearnError(
            f"{shown_path(file)}: is damaged; remove the folder and train again"
        ) from None
    return lines[:epochs]


def _board(folder: Path) -> Any:
    from torch.utils.tensorboard import SummaryWriter

    return SummaryWriter(str(folder / BOARD))


def draw_curves(log: list[dict[str, float]], out: Path) -> None:
    """Losses by epoch, those of held-out garments dashed, as a PNG."""
    from io import BytesIO

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = [
        name
        for name in log[0]
        if not name.startswith("held-out") and name not in ("epoch", "seconds", "samples_a_second")
    ]
    figure = Figure(figsize=(3.2 * len(names), 2.8), layout="constrained")
    FigureCanvasAgg(figure)
    for place, name in enumerate(names):
        axes = figure.add_subplot(1, len(names), place + 1)
        epochs = [line["epoch"] for line in log]
        axes.plot(epochs, [line[name] for line in log], label="training")
        axes.plot(epochs, [line[f"held-out {name}"] for line in log], "--", label="held out")
        axes.set(title=name, xlabel="epoch", yscale="log")
        axes.grid(alpha=0.3)
    axes.legend()
    file = BytesIO()
    figure.savefig(file, format="png", dpi=110)
    write_atomically(out, file.getvalue())
