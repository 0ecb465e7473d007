"""Bundled sewing patterns and a picture, for examples and first steps.

dress: a one-piece dress with short sleeves. darted_shirt: a fitted shirt with waist and bust
darts. trousers: straight trousers with a waistband. cutout_top: a sleeveless top with a hole in
the front. `scripts/draw_examples.py` draws them.

worn.png is the picture of a worn garment, drafted and draped by the package, that its networks
were not trained on; `make picture` makes it.
"""

from pathlib import Path

_FOLDER = Path(__file__).parent


def example_names() -> tuple[str, ...]:
    """Names of the bundled patterns, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.json")))


def example_path(name: str) -> Path:
    """Where the bundled pattern `name` lies.

    Raises:
        KeyError: no pattern has this name.
    """
    if name not in example_names():
        raise KeyError(f"no example {name!r}; there are {', '.join(example_names())}")
    return _FOLDER / f"{name}.json"


def example_picture() -> Path:
    """Where the bundled picture lies."""
    return _FOLDER / "worn.png"
