"""Do the public functions still give the same, bit for bit? Run before and after a rebuild.

    python scripts/result_hashes.py [FOLDER...] -o before.json
    python scripts/result_hashes.py [FOLDER...] --against before.json

Hashes what is drafted, encoded, decoded (with marks and from channels alone), draped, predicted
from a picture and interpolated: of the bundled patterns, of 500 drafts, and of 200 pattern files of
the folders. Messages are not hashed, only the kind of an error. Hashes hold for one machine and one
set of installed packages.
"""

import argparse
import hashlib
import json
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from tqdm import tqdm

import garmentimage as gi
from garmentimage.examples import example_names, example_path, example_picture

DRAFTS = 500
FILES = 200
SEED = 31
SPACE = "vae-variety"
NETWORKS = "image-wide", "image-d1", "image-d2"
PAIRS = 10
STEPS = 5

Hashes = dict[str, str]
Source = tuple[str, int] | Path
"""Kind and index of a draft, or a pattern file."""


def main() -> int:
    """Hash, write, compare."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="*", type=Path, help="pattern files by others")
    parser.add_argument("-o", "--out", type=Path, help="JSON of all hashes")
    parser.add_argument("--against", type=Path, help="hashes of before")
    parser.add_argument("--no-drape", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    args = parser.parse_args()
    sources = list(_sources(args.folders))
    hashes: Hashes = {}
    with ProcessPoolExecutor(args.workers, mp_context=get_context("spawn")) as pool:
        found = pool.map(_of_pattern, sources, [not args.no_drape] * len(sources), chunksize=4)
        for each in tqdm(found, total=len(sources), unit=" patterns"):
            hashes |= each
    hashes |= _of_networks()
    if args.out:
        args.out.write_text(json.dumps(hashes, indent=1) + "\n", encoding="utf-8")
    for what, count in sorted(Counter(name.split(" ")[0] for name in hashes).items()):
        print(f"{what:12}{count:6} hashes")
    return _compare(json.loads(args.against.read_text()), hashes) if args.against else 0


def _compare(before: Hashes, now: Hashes) -> int:
    different = sorted(name for name in now if before.get(name) != now[name])
    for name in different:
        print(f"different: {name}")
    print(f"{len(now) - len(different)} of {len(now)} the same")
    return int(bool(different))


def _sources(folders: list[Path]) -> Iterator[Source]:
    for name in example_names():
        yield example_path(name)
    names = list(gi.kinds())
    for number in range(DRAFTS):
        yield names[number % len(names)], number // len(names)
    files = sorted(
        path
        for folder in folders
        for path in folder.rglob("*.json")
        if not path.name.endswith("manifest.json")
    )
    chosen = np.random.default_rng(SEED).permutation(len(files))[:FILES]
    yield from (files[int(each)] for each in chosen)


def _of_pattern(source: Source, drape: bool) -> Hashes:
    """All hashes of one pattern."""
    # Warnings report findings in files by others, which are not compared.
    warnings.simplefilter("ignore")
    if isinstance(source, Path):
        name = f"{source.parent.name}/{source.name}"
        pattern = _guarded(lambda: gi.load_pattern(source))
    else:
        kind, index = source
        name = f"{kind}/{index}"
        pattern = next(gi.sample(kind, 1, SEED, first=index)).pattern
    hashes = {f"pattern {name}": _digest(pattern)}
    if not isinstance(pattern, gi.Pattern):
        return hashes
    for grid in 16, 32:
        image = _guarded(lambda grid=grid: gi.encode(pattern, grid=grid))
        hashes[f"encode {name} {grid}"] = _digest(image)
        if not isinstance(image, gi.GarmentImage):
            continue
        channels = image.to_channels()
        hashes[f"decode {name} {grid}"] = _digest(_guarded(lambda i=image: gi.decode(i)))
        hashes[f"channels {name} {grid}"] = _digest(_guarded(lambda c=channels: gi.decode(c)))
    if drape:
        hashes[f"drape {name}"] = _digest(_guarded(lambda: gi.drape_pattern(pattern)))
    return hashes


def _of_networks() -> Hashes:
    """What the shipped networks predict, and what lies between drafts."""
    hashes: Hashes = {}
    for name in NETWORKS:
        channels = gi.PatternPredictor.load(name).predict(example_picture()).channels
        hashes[f"predict {name}"] = _digest(gi.decode(channels, kind="shares"))
    space = gi.LatentSpace.load(SPACE)
    dresses = gi.sample("one-panel-dress", PAIRS, SEED, fixed={"cutout": "none"})
    tops = gi.sample("top-pants", PAIRS, SEED)
    for number, (a, b) in enumerate(zip(dresses, tops, strict=True)):
        for step, each in enumerate(gi.interpolate(space, a.pattern, b.pattern, STEPS)):
            hashes[f"interpolate {number}/{step}"] = _digest(each.pattern)
    return hashes


def _guarded(make: Callable[[], object]) -> object:
    """What is made, or the name of the error."""
    try:
        return make()
    except gi.GarmentImageError as error:
        return type(error).__name__


def _digest(value: object) -> str:
    """SHA-256 of a pattern, an image, a worn garment, or the name of an error."""
    digest = hashlib.sha256()
    if isinstance(value, gi.Pattern):
        with tempfile.TemporaryDirectory() as folder:
            gi.save_pattern(value, Path(folder, "pattern.json"))
            digest.update(Path(folder, "pattern.json").read_bytes())
    elif isinstance(value, gi.GarmentImage):
        digest.update(np.ascontiguousarray(value.to_channels()).tobytes())
    elif isinstance(value, gi.DrapedGarment):
        digest.update(np.ascontiguousarray(value.points).tobytes())
        digest.update(f"{len(value.report.faults)} faults".encode())
    else:
        digest.update(str(value).encode())
    return digest.hexdigest()


if __name__ == "__main__":
    sys.exit(main())
