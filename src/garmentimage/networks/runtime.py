"""Networks in folders, `config.json` and ONNX files, read with distrust and run on one core."""

import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.errors import LearnError, quoted
from garmentimage.raster import CHANNEL_CONTRACT
from garmentimage.system import did_you_mean, shown_path

WEIGHTS_FOLDER = Path(str(files("garmentimage") / "weights"))
"""Where networks lie that come with the package."""
CONFIG_FILE = "config.json"
MAX_VALUE = 1e6
"""No number of a network's is as large."""


def bundled_names(file: str) -> tuple[str, ...]:
    """Names of the networks that come with the package and have this file."""
    return tuple(sorted(found.parent.name for found in WEIGHTS_FOLDER.glob(f"*/{file}")))


def network_folder(name: str | Path, known: Sequence[str], what: str) -> Path:
    """Where a network is that comes with the package, by name, or one in a folder.

    Raises:
        LearnError: there is none of that name, and no such folder.
    """
    if str(name) in known:
        return WEIGHTS_FOLDER / str(name)
    try:
        is_folder = Path(name).is_dir()
    except (OSError, ValueError):  # a name that no file can have
        is_folder = False
    if is_folder:
        return Path(name)
    ways = f"{did_you_mean(str(name), known)}, or " if known else ""
    raise LearnError(f"there is no {what} {quoted(str(name))}; {ways}name the folder of one")


def check_contract(config: Mapping[str, Any], where: str | Path) -> None:
    """Refuse a network that was made for other channels than this version has.

    Raises:
        LearnError: says so.
    """
    found = config.get("channels_contract")
    if found != CHANNEL_CONTRACT:
        raise LearnError(
            f"{shown_path(where)}: was made for channels {quoted(str(found))}, and this version "
            f"has {CHANNEL_CONTRACT!r}; train it again, or use the version that it came with"
        )


def read_config(folder: Path, sizes: Sequence[str]) -> dict[str, Any]:
    """What a network in a folder was made for.

    Args:
        folder: the network.
        sizes: names of whole numbers that its configuration must have.

    Raises:
        LearnError: there is none, or it was made for other channels than this version has.
    """
    file = folder / CONFIG_FILE
    try:
        config = json.loads(file.read_text(encoding="utf-8"))
        numbers: Sequence[Any] = [config[name] for name in sizes]
        if not all(type(n) is int and 1 <= n <= 4096 for n in numbers):
            raise ValueError
    except FileNotFoundError:
        raise LearnError(
            f"{shown_path(folder)}: holds no trained network (there is no {CONFIG_FILE})"
        ) from None
    except OSError as error:
        raise LearnError(f"{shown_path(file)}: cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise damaged_file(file) from None
    check_contract(config, file)
    return config


def open_session(file: Path, sizes: Mapping[str, Sequence[int]]) -> Any:
    """The network in a file, to be run on one core.

    Args:
        file: ONNX.
        sizes: by name, the shape of an example of what it takes, and then of what it gives.

    Raises:
        LearnError: the file cannot be read, or holds no network of these sizes.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        raw = file.read_bytes()
        if b"location" in raw:  # the word by which weights in other files are named
            raise ValueError
        session = onnxruntime.InferenceSession(raw, options, providers=["CPUExecutionProvider"])
        takes, gives = session.get_inputs(), session.get_outputs()
        if [each.name for each in (*takes, *gives)] != list(sizes):
            raise ValueError
        if not all(_has_shape(each, sizes[each.name]) for each in (*takes, *gives)):
            raise ValueError
        return session
    except OSError as error:
        raise LearnError(f"{shown_path(file)}: cannot be read ({error.strerror})") from None
    except Exception as error:  # onnxruntime has no base class of its own for its errors.
        raise damaged_file(file) from error


def _has_shape(found: Any, size: Sequence[int]) -> bool:
    """Whether an input or output takes any number of examples of a size."""
    count, *rest = found.shape
    return (
        found.type == "tensor(float)"
        and type(count) is not int
        and len(rest) == len(size)
        and all(type(n) is not int or n == m for n, m in zip(rest, size))
    )


def run_session(session: Any, file: Path, given: np.ndarray) -> np.ndarray:
    """What a network of one input and one output gives.

    Raises:
        LearnError: it fails, or gives what are no numbers.
    """
    (takes,), (gives,) = session.get_inputs(), session.get_outputs()
    try:
        (found,) = session.run(None, {takes.name: np.asarray(given, np.float32)})
    except Exception as error:  # onnxruntime has no base class of its own for its errors.
        raise damaged_file(file) from error
    is_whole = found.shape[:1] == given.shape[:1] and found.ndim == len(gives.shape)
    if not is_whole or not np.abs(found).max(initial=0) < MAX_VALUE:
        raise damaged_file(file)
    return np.asarray(found)


def damaged_file(file: Path) -> LearnError:
    """The error of a network's file that does not hold what it should."""
    return LearnError(f"{shown_path(file)}: is damaged, or none of ours; get it again")
