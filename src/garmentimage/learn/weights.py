"""Weights on disk: safetensors with `config.json`, as `from_pretrained` reads them."""

import json
from contextlib import redirect_stdout
from dataclasses import dataclass, field, fields
from io import StringIO
from pathlib import Path
from typing import TypeVar

from huggingface_hub import PyTorchModelHubMixin
from torch import nn

from garmentimage.errors import LearnError
from garmentimage.networks import CONFIG_FILE, check_contract
from garmentimage.raster import CHANNEL_CONTRACT
from garmentimage.system import shown_path

WEIGHTS_CONTRACT = 2
"""Version of the names of weights and of configuration fields; files without one are of version 1.
`scripts/migrate_weights.py` renames those."""


class Network(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """A network that is saved with its configuration, the only argument of its constructor."""


Model = TypeVar("Model", bound=Network)


@dataclass(frozen=True)
class NetworkConfig:
    """What the configuration of every network has."""

    weights_contract: int = field(default=WEIGHTS_CONTRACT, kw_only=True)
    """Version of the names in its files."""

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, list):  # JSON has lists; tuples keep configurations comparable
                object.__setattr__(self, each.name, tuple(value))


@dataclass(frozen=True)
class ImageNetworkConfig(NetworkConfig):
    """What the configuration of every network has whose output are GarmentImages.

    Raises:
        LearnError: it was made for another channel layout than this version's.
    """

    channels_contract: str = CHANNEL_CONTRACT
    """Channel layout that the network was made for."""
    grid: int = 16
    """Cells a side, N."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_channels()

    def check_channels(self) -> None:
        """Refuse channels that the network cannot have: most know contract 1 alone."""
        check_contract(self.channels_contract)


def load_weights(kind: type[Model], folder: str | Path) -> Model:
    """A network from a local folder that `save_pretrained` wrote, ready for use.

    Raises:
        LearnError: the files are missing, damaged, of another kind, size or version.
    """
    folder = Path(folder)
    if not (folder / CONFIG_FILE).is_file():
        raise LearnError(f"{shown_path(folder)}: holds no network (there is no {CONFIG_FILE})")
    try:
        _check_version(folder)
        with redirect_stdout(StringIO()):  # The loader prints where it loads from.
            model = kind.from_pretrained(str(folder), local_files_only=True, strict=True)
    except LearnError as error:
        raise LearnError(f"{shown_path(folder)}: {error}") from None
    except Exception as error:  # noqa: BLE001  four libraries have errors of their own
        raise LearnError(
            f"{shown_path(folder)}: holds no {kind.__name__} that can be read "
            f"({type(error).__name__}); get it again"
        ) from None
    if not all(bool(part.isfinite().all()) for part in model.state_dict().values()):
        raise LearnError(f"{shown_path(folder)}: has NaN or infinite weights; get it again")
    return model.eval()


def _check_version(folder: Path) -> None:
    """Refuse files with names of another version; errors of a damaged file pass through."""
    config = json.loads((folder / CONFIG_FILE).read_text(encoding="utf-8"))
    found = config.get("weights_contract", 1)
    if found == 1:
        raise LearnError(
            "has weights with names of an earlier version; rename them once with "
            f"`python scripts/migrate_weights.py {shown_path(folder)}`"
        )
    if found != WEIGHTS_CONTRACT:
        raise LearnError(
            f"has weights of version {found!r}, and this package reads {WEIGHTS_CONTRACT}; use the "
            "package that wrote them"
        )
