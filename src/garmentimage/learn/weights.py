"""Weights on disk: safetensors with `config.json`, as `from_pretrained` reads them."""

from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import TypeVar

from torch import nn

from garmentimage.errors import LearnError
from garmentimage.system import shown_path

Model = TypeVar("Model", bound=nn.Module)


def load_weights(kind: type[Model], folder: str | Path) -> Model:
    """A network from a local folder that `save_pretrained` wrote, ready for use.

    Raises:
        LearnError: it is not there, damaged, or of another kind or size.
    """
    folder = Path(folder)
    if not (folder / "config.json").is_file():
        raise LearnError(f"{shown_path(folder)}: holds no network (there is no config.json)")
    try:
        with redirect_stdout(StringIO()):  # It would tell where it loads from.
            model = kind.from_pretrained(  # type: ignore[attr-defined]
                str(folder), local_files_only=True, strict=True
            )
    except LearnError as error:
        raise LearnError(f"{shown_path(folder)}: {error}") from None
    except Exception as error:  # What may go wrong spans four libraries.
        raise LearnError(
            f"{shown_path(folder)}: holds no {kind.__name__} that can be read "
            f"({type(error).__name__}); get it again"
        ) from None
    if not all(bool(part.isfinite().all()) for part in model.state_dict().values()):
        raise LearnError(f"{shown_path(folder)}: has weights that are no numbers; get it again")
    return model.eval()  # type: ignore[no-any-return]
