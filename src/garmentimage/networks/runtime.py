"""Networks in folders, `config.json` and ONNX files: read with checks, and run on one core."""

import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Float32

from garmentimage.errors import LearnError, quoted
from garmentimage.raster import (
    CHANNEL_CONTRACT,
    CONTRACTS,
    MAX_LAYERS,
    PLAIN_LAYOUT,
    ChannelLayout,
)
from garmentimage.system import did_you_mean, shown_path

WEIGHTS_FOLDER = Path(str(files("garmentimage") / "weights"))
"""Folder of the bundled networks."""
CONFIG_FILE = "config.json"
LATENT_CONTRACTS = tuple(contract.name for contract in CONTRACTS.values())
"""Channel contracts that latent spaces are made for."""
MAX_VALUE = 1e6
"""Output with larger numbers is invalid."""


def bundled_names(file: str) -> tuple[str, ...]:
    """Names of the bundled networks that have this file."""
    return tuple(sorted(found.parent.name for found in WEIGHTS_FOLDER.glob(f"*/{file}")))


def network_folder(name: str | Path, known: Sequence[str], what: str) -> Path:
    """The folder of a bundled network, by name, or of another.

    Args:
        name: of a bundled network, or a folder.
        known: names of bundled networks.
        what: the kind of network, for messages.

    Raises:
        LearnError: there is no bundled network of that name, and no such folder.
    """
    if str(name) in known:
        return WEIGHTS_FOLDER / str(name)
    try:
        is_folder = Path(name).is_dir()
    except (OSError, ValueError):  # a name that no file can have
        is_folder = False
    if is_folder:
        return Path(name)
    hint = f"{did_you_mean(str(name), known)}, or " if known else ""
    raise LearnError(f"there is no {what} {quoted(str(name))}; {hint}name the folder of one")


def check_contract(found: object, known: Sequence[str] = (CHANNEL_CONTRACT,)) -> None:
    """Refuse a network that was made for another channel contract than those known for its kind.

    Raises:
        LearnError: it was.
    """
    if found not in known:
        raise LearnError(
            f"was made for channels {quoted(str(found))}, and this version has "
            f"{' and '.join(map(repr, known))}; train it again, or use the version that trained it"
        )


def channel_layout(contract: object, layers: object) -> ChannelLayout:
    """The channels of a network, from its configuration.

    Raises:
        LearnError: no contract of this version, or a number of layers that it does not have.
    """
    check_contract(contract, LATENT_CONTRACTS)
    if type(layers) is not int or layers % 2 or not 2 <= layers <= MAX_LAYERS:
        raise LearnError(
            f"has {quoted(str(layers))} layers; give 2, front and back, or 4 with a second sheet"
        )
    if contract == CHANNEL_CONTRACT and layers != PLAIN_LAYOUT.layers:
        raise LearnError(f"contract 1 has two layers, not {layers}; train with --contract 2")
    (chosen,) = (each for each in CONTRACTS.values() if each.name == contract)
    return ChannelLayout(chosen, layers)


def read_config(
    folder: Path, sizes: Sequence[str], known: Sequence[str] = (CHANNEL_CONTRACT,)
) -> dict[str, Any]:
    """The configuration of a network.

    Args:
        folder: of the network.
        sizes: names of the whole numbers that it must have.
        known: channel contracts that its kind may have.

    Raises:
        LearnError: it is missing, damaged, or of another channel layout.
    """
    file = folder / CONFIG_FILE
    try:
        config: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        if not all(type(config[name]) is int and 1 <= config[name] <= 4096 for name in sizes):
            raise ValueError
        check_contract(config.get("channels_contract"), known)
        return config
    except FileNotFoundError:
        raise LearnError(
            f"{shown_path(folder)}: holds no trained network (there is no {CONFIG_FILE})"
        ) from None
    except OSError as error:
        raise unreadable(file, error) from None
    except LearnError as error:
        raise LearnError(f"{shown_path(file)}: {error}") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise damaged_file(file) from None


class OnnxNetwork:
    """An ONNX file with one input and one output, opened at the first call, run on one core.

    Args:
        file: ONNX.
        sizes: shapes of an example by name, of the input, then of the output.
    """

    def __init__(self, file: Path, sizes: Mapping[str, Sequence[int]]) -> None:
        self.file, self.sizes = file, sizes

    @cached_property
    def _session(self) -> Any:
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        options.log_severity_level = 4
        try:
            raw = self.file.read_bytes()
            if b"location" in raw:  # the key that names weights in other files, which are refused
                raise ValueError
            session = onnxruntime.InferenceSession(raw, options, providers=["CPUExecutionProvider"])
            ends = [*session.get_inputs(), *session.get_outputs()]
            if [each.name for each in ends] != list(self.sizes):
                raise ValueError
            if not all(_has_shape(each, self.sizes[each.name]) for each in ends):
                raise ValueError
            return session
        except OSError as error:
            raise unreadable(self.file, error) from None
        except Exception as error:  # onnxruntime's errors have no base class
            raise damaged_file(self.file) from error

    def __call__(self, given: Float[np.ndarray, "n ..."]) -> Float32[np.ndarray, "n ..."]:
        """Run the network on a batch.

        Raises:
            LearnError: the file cannot be read or holds no network of these shapes; it fails, or
                its output has NaN, infinite or huge values.
        """
        session = self._session
        try:
            (found,) = session.run(None, {next(iter(self.sizes)): np.asarray(given, np.float32)})
        except Exception as error:  # onnxruntime's errors have no base class
            raise damaged_file(self.file) from error
        is_whole = found.shape[:1] == given.shape[:1] and found.ndim == len(
            session.get_outputs()[0].shape
        )
        if not is_whole or not np.abs(found).max(initial=0) < MAX_VALUE:
            raise damaged_file(self.file)
        return np.asarray(found)


def _has_shape(found: Any, size: Sequence[int]) -> bool:
    """Whether an input or output is a batch of any size of examples of this shape."""
    count, *rest = found.shape
    return (
        found.type == "tensor(float)"
        and type(count) is not int
        and len(rest) == len(size)
        and all(type(n) is not int or n == m for n, m in zip(rest, size, strict=True))
    )


def read_arrays(file: Path, **kinds: str) -> list[np.ndarray]:
    """Arrays of an npz file by name.

    Args:
        file: npz.
        kinds: `dtype.kind` of each array, such as "f".

    Raises:
        LearnError: it is missing or damaged.
    """
    try:
        with np.load(file, allow_pickle=False) as content:
            found = [content[name] for name in kinds]
        if [array.dtype.kind for array in found] != list(kinds.values()):
            raise ValueError
        return found
    except Exception as error:  # zipfile, zlib and numpy each have their own
        raise damaged_file(file) from error


def damaged_file(file: Path) -> LearnError:
    """The error for a file of a network that is invalid."""
    return LearnError(f"{shown_path(file)}: is damaged, or none of ours; get it again")


def unreadable(file: Path, error: OSError) -> LearnError:
    """The error for a file that cannot be opened."""
    return LearnError(f"{shown_path(file)}: cannot be read ({error.strerror})")
