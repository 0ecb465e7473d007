"""Training: one loop for every network, resumable, with the same result for the same seed.

A run is a folder: `run.json` (settings, commit, data), `checkpoint.ckpt` (rewritten after every
epoch), `log.jsonl` (a line an epoch), `tensorboard/`, `curves.png`, and at the end `model/` with
the averaged weights.
"""

import copy
import math
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from lightning_fabric import Fabric
from torch import nn

from garmentimage.errors import LearnError
from garmentimage.learn.data import TensorRows
from garmentimage.learn.run_folder import (
    CHECKPOINT,
    CURVES_FILE,
    RunLog,
    draw_curves,
    prepare_run,
    read_log,
)
from garmentimage.learn.settings import TrainingSettings
from garmentimage.system import shown_path

WARM_UP_SHARE = 0.02
"""Share of all steps in which the learning rate rises from 0."""
EMA_DECAY = 0.999
"""Share of the averaged weights that a step keeps."""
BETAS = (0.9, 0.99)
"""Of AdamW: decay of the gradient's first and second moments."""
MAX_GRADIENT_NORM = 1.0
EPOCH_SEED, RANK_SEED = 1_000_003, 500_009
"""Primes that keep the seeds of epochs, and of ranks in an epoch, apart."""


@dataclass(frozen=True)
class TrainingResult:
    """A trained network, and its losses."""

    model: nn.Module
    """With the averaged weights."""
    log: tuple[dict[str, float], ...]
    """Losses by epoch."""


@dataclass
class _State:
    """What a checkpoint holds, and Fabric writes and reads."""

    model: Any
    """The network as Fabric wraps it."""
    optimizer: torch.optim.Optimizer
    average: nn.Module
    """The network with averaged weights."""
    epoch: int = 0
    """Epochs done."""
    step: int = 0
    """Steps done."""


def train(
    model: nn.Module,
    train_set: TensorRows,
    held_out: TensorRows,
    *,
    folder: Path,
    settings: TrainingSettings,
    facts: Mapping[str, Any],
    progress: Callable[[dict[str, float]], None] = lambda _: None,
) -> TrainingResult:
    """Train a network, or resume its run.

    Minimises the network's `loss` by AdamW (Loshchilov and Hutter 2019) with gradient clipping,
    linear warm-up and cosine decay (Loshchilov and Hutter 2017); an exponential moving average of
    the weights is the result (Polyak averaging).

    Args:
        model: a new network; its forward pass turns a batch into losses, of which `loss` is the sum
            that is minimised.
        train_set: the training set.
        held_out: the validation set, on which losses are logged; nothing is selected by them.
        folder: of the run; resumed where it exists.
        settings: how.
        facts: what else identifies the run: network, its configuration, data.
        progress: called after every epoch with its losses.

    Raises:
        LearnError: the folder holds another run, the accelerator does not exist, or the loss
            becomes NaN or infinite.
    """
    fabric = _fabric(settings)
    prepare_run(folder, {"settings": asdict(settings), **facts})
    fabric.launch()
    state = _start(fabric, model, settings)
    if (folder / CHECKPOINT).exists():
        _resume(fabric, folder / CHECKPOINT, state)
    log = RunLog(folder, read_log(folder, state.epoch), is_writer=fabric.is_global_zero)
    for epoch in range(state.epoch, settings.epochs):
        began = time.perf_counter()
        line, count = _epoch(fabric, state, model, train_set, settings)
        held_out_losses = _held_out_losses(state.average, held_out, settings.seed)
        line |= {f"held-out {name}": value for name, value in held_out_losses.items()}
        if not math.isfinite(line["loss"]):
            raise LearnError(
                f"the loss is NaN or infinite in epoch {epoch + 1}; choose another folder, and a "
                "lower learning rate, or look for NaN or infinite values in the data"
            )
        state.epoch, seconds = epoch + 1, time.perf_counter() - began
        line |= {"epoch": epoch + 1, "seconds": round(seconds, 2)}
        line["samples_a_second"] = round(count / seconds, 1)
        _save_checkpoint(fabric, folder / CHECKPOINT, state)
        log.add(line)
        progress(line)
    log.close()
    if fabric.is_global_zero:
        draw_curves(log.lines, folder / CURVES_FILE)
    return TrainingResult(state.average.cpu().eval(), tuple(log.lines))


def _fabric(settings: TrainingSettings) -> Fabric:
    auto = settings.precision == "auto"
    precision: Any = fitting_precision(settings.accelerator) if auto else settings.precision
    try:
        return Fabric(
            accelerator=settings.accelerator,
            devices=settings.devices,
            num_nodes=settings.nodes,
            precision=precision,
        )
    except (RuntimeError, ValueError) as error:  # an accelerator that does not exist
        raise LearnError(f"cannot train on this machine: {error}") from None


def _start(fabric: Fabric, model: nn.Module, settings: TrainingSettings) -> _State:
    optimizer = torch.optim.AdamW(
        model.parameters(), settings.rate, weight_decay=settings.decay, betas=BETAS
    )
    average = copy.deepcopy(model)
    wrapped, optimizer = fabric.setup(model, optimizer)
    return _State(wrapped, optimizer, average.to(fabric.device))


def _epoch(
    fabric: Fabric,
    state: _State,
    model: nn.Module,
    train_set: TensorRows,
    settings: TrainingSettings,
) -> tuple[dict[str, float], int]:
    """Train for an epoch.

    Returns:
        Mean losses of its steps, and how many examples they had on all devices.
    """
    step_size = settings.batch * fabric.world_size
    steps = max(len(train_set) // step_size, 1)
    # All ranks draw the same order, and each its own noise; both depend on seed and epoch alone, so
    # that a resumed run goes through the same batches.
    seed = settings.seed * EPOCH_SEED + state.epoch
    torch.manual_seed(seed)
    order = torch.randperm(len(train_set))
    torch.manual_seed(seed + RANK_SEED * (1 + fabric.global_rank))
    state.model.train()
    sums: dict[str, float] = defaultdict(float)
    for step in range(steps):
        first = step * step_size + fabric.global_rank * settings.batch
        batch = train_set.batch(order[first : first + settings.batch]).to(fabric.device)
        rate = settings.rate * warmup_cosine(state.step, settings.epochs * steps)
        for group in state.optimizer.param_groups:
            group["lr"] = rate
        losses = state.model(batch)
        state.optimizer.zero_grad()
        fabric.backward(losses["loss"])
        fabric.clip_gradients(
            state.model, state.optimizer, max_norm=MAX_GRADIENT_NORM, error_if_nonfinite=False
        )
        state.optimizer.step()
        update_ema(state.average, model, state.step)
        state.step += 1
        for name, value in losses.items():
            sums[name] += float(value.detach())
    return {name: value / steps for name, value in sums.items()}, steps * step_size


def fitting_precision(accelerator: str) -> str:
    """Mixed precision with bfloat16 where the hardware computes it, otherwise full precision.

    Processors without it emulate it, ten times slower than full precision.
    """
    if accelerator in ("gpu", "cuda", "auto") and torch.cuda.is_available():
        is_quick = torch.cuda.is_bf16_supported(including_emulation=False)
    elif accelerator in ("cpu", "auto"):
        # Older versions of torch do not report capabilities.
        can: Mapping[str, Any] = getattr(torch.cpu, "get_capabilities", dict)()
        is_quick = any(can.get(name, False) for name in ("avx512_bf16", "amx_bf16", "bf16"))
    else:
        is_quick = False
    return "bf16-mixed" if is_quick else "32-true"


def warmup_cosine(step: int, steps: int) -> float:
    """Share of the highest learning rate: a linear rise, then half a cosine.

    By hand rather than a `LambdaLR`: a function of the step alone has no state to save and restore.
    """
    warm_up = max(WARM_UP_SHARE * steps, 1)
    if step < warm_up:
        return (step + 1) / (warm_up + 1)
    return 0.5 * (1 + math.cos(math.pi * min((step - warm_up) / max(steps - warm_up, 1), 1)))


@torch.no_grad()
def update_ema(average: nn.Module, model: nn.Module, step: int) -> None:
    """Move averaged weights towards those of the model: a <- d a + (1 - d) w.

    The decay d grows as (1 + step) / (10 + step) up to `EMA_DECAY`, so that the first weights,
    which are random, are soon forgotten. By hand rather than `swa_utils.AveragedModel`, which adds
    a step count and a wrapper to checkpoints and would only call the same lerp.
    """
    decay = min(EMA_DECAY, (1 + step) / (10 + step))
    for ours, theirs in zip(average.parameters(), model.parameters(), strict=True):
        ours.lerp_(theirs, 1 - decay)
    for buffer, other in zip(average.buffers(), model.buffers(), strict=True):
        buffer.copy_(other)


@torch.no_grad()
def _held_out_losses(model: nn.Module, held_out: TensorRows, seed: int) -> dict[str, float]:
    """Mean losses of the held-out set, with the same noise after every epoch."""
    model.eval()
    torch.manual_seed(seed)
    sums: dict[str, float] = defaultdict(float)
    device = next(model.parameters()).device
    for batch in held_out.parts():
        for name, value in model(batch.to(device)).items():
            sums[name] += float(value) * len(batch) / len(held_out)
    return sums


def _resume(fabric: Fabric, file: Path, state: _State) -> None:
    try:
        # Networks and optimizer are restored in place, numbers in `vars(state)` or in the rest.
        rest = fabric.load(file, vars(state), weights_only=True)
        content = {**vars(state), **rest}
        state.epoch, state.step = int(content["epoch"]), int(content["step"])
    except Exception as error:
        raise LearnError(
            f"{shown_path(file)}: is damaged, or of another network; remove the folder and train "
            "again"
        ) from error


def _save_checkpoint(fabric: Fabric, file: Path, state: _State) -> None:
    part = file.with_name(f"{file.name}.part")
    fabric.save(part, vars(state))
    if fabric.is_global_zero:
        part.replace(file)
