"""The folder of a training run: what identifies it, its log, and the curves of its losses."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from garmentimage.errors import LearnError
from garmentimage.system import shown_path, source_commit, versions, write_atomically

RUN_FILE, LOG_FILE, CHECKPOINT = "run.json", "log.jsonl", "checkpoint.ckpt"
CURVES_FILE, MODEL_FOLDER, BOARD_FOLDER = "curves.png", "model", "tensorboard"
NOT_LOSSES = ("epoch", "seconds", "samples_a_second")
"""Fields of a log line."""


class RunLog:
    """Losses by epoch, written to `log.jsonl` and to tensorboard.

    Args:
        folder: of the run.
        lines: of the epochs before.
        is_writer: whether this process writes them; with several devices, one does.
    """

    def __init__(self, folder: Path, lines: list[dict[str, float]], *, is_writer: bool) -> None:
        self.folder, self.lines = folder, lines
        self._board: Any = None
        if is_writer:
            from torch.utils.tensorboard import SummaryWriter

            self._board = SummaryWriter(str(folder / BOARD_FOLDER))

    def add(self, line: dict[str, float]) -> None:
        """Append the losses of an epoch."""
        self.lines.append(line)
        if self._board is None:
            return
        text = "".join(json.dumps(each) + "\n" for each in self.lines)
        write_atomically(self.folder / LOG_FILE, text)
        for name, value in line.items():
            self._board.add_scalar(name.replace(" ", "/"), value, line["epoch"])

    def close(self) -> None:
        """Flush and close tensorboard."""
        if self._board is not None:
            self._board.close()


def prepare_run(folder: Path, run: Mapping[str, Any]) -> None:
    """Make the folder of a new run, or check that the run in it is this one.

    Args:
        folder: of the run.
        run: what identifies it.

    Raises:
        LearnError: it holds another run, is damaged, or cannot be used.
    """
    file = folder / RUN_FILE
    plain = json.loads(json.dumps(run))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _check_names(folder)
        if file.exists():
            found = json.loads(file.read_text(encoding="utf-8"))
            found["commit"]  # a KeyError where the file is cut short
            _check_same(folder, found["run"], plain)
            return
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, LearnError):
            raise
        raise LearnError(f"{shown_path(file)}: is damaged; choose another folder") from None
    except OSError as error:
        raise LearnError(
            f"{shown_path(folder)}: cannot be used ({error.strerror}); choose another folder"
        ) from None
    content = {"run": plain, "commit": source_commit(), "versions": versions("torch")}
    write_atomically(file, json.dumps(content, indent=1) + "\n")


def _check_names(folder: Path) -> None:
    """Refuse a folder with files of ours that are not ours, or a checkpoint of an unknown run."""
    is_ours = ((MODEL_FOLDER, Path.is_dir), (BOARD_FOLDER, Path.is_dir), (LOG_FILE, Path.is_file))
    for name, is_right in is_ours:
        if (folder / name).exists() and not is_right(folder / name):
            raise LearnError(
                f"{shown_path(folder / name)}: already exists and is not ours; remove it"
            )
    if (folder / CHECKPOINT).exists() and not (folder / RUN_FILE).exists():
        raise LearnError(
            f"{shown_path(folder)}: holds a checkpoint of an unknown run (there is no {RUN_FILE}); "
            "choose another folder"
        )


def _check_same(folder: Path, found: dict[str, Any], run: dict[str, Any]) -> None:
    if found != run:
        names = [key for key in run if found.get(key) != run[key]]
        raise LearnError(
            f"{shown_path(folder)}: holds a run with other {', '.join(names)}; choose another "
            f"folder, or the settings in its {RUN_FILE}"
        )


def read_log(folder: Path, epochs: int) -> list[dict[str, float]]:
    """The log of the first epochs.

    Raises:
        LearnError: it is missing, damaged or shorter.
    """
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


def draw_curves(log: Sequence[Mapping[str, float]], out: Path) -> None:
    """Draw losses by epoch as a PNG, held-out ones dashed."""
    from io import BytesIO

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = [name for name in log[0] if not name.startswith("held-out") and name not in NOT_LOSSES]
    figure = Figure(figsize=(3.2 * len(names), 2.8), layout="constrained")
    FigureCanvasAgg(figure)
    epochs = [line["epoch"] for line in log]
    for number, name in enumerate(names):
        axes = figure.add_subplot(1, len(names), number + 1)
        axes.plot(epochs, [line[name] for line in log], label="training")
        axes.plot(epochs, [line[f"held-out {name}"] for line in log], "--", label="held out")
        axes.set(title=name, xlabel="epoch", yscale="log")
        axes.grid(alpha=0.3)
    axes.legend()
    file = BytesIO()
    figure.savefig(file, format="png", dpi=110)
    write_atomically(out, file.getvalue())
