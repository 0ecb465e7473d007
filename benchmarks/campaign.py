"""Mutated patterns through check, encode, decode and drape: does anything crash, hang or lie?

    python benchmarks/campaign.py FOLDER... --records DIR [--first 0] [--count 20000] [--seed 0]
                                  [--workers 2] [--steps encode drape] [-o OUT.json]

Number k of a seed is one garment, a file of the folders or (one in five) a drafted one, mutated in
one way (`mutations.py`). Each goes through every step in a process of its own, with a limit of
time and of memory. Judged are the stitch graph of what comes back from the raster, against the
mutated pattern, or against the whole one where the mutation leaves it the same garment; and where
the cloth lies, against the whole garment on the same body.

What is measured is kept in the folder of the records, so that a run that was stopped goes on.
"""

import argparse
import copy
import json
import resource
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from mutations import MUTATIONS, Expected
from provenance import data_hash, provenance

from garmentimage.compare.comparison import compare_patterns
from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import sample
from garmentimage.drape.draping import drape_pattern
from garmentimage.errors import GarmentImageError
from garmentimage.evaluate.records import Records
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.files.spec_writer import pattern_to_spec
from garmentimage.pattern.model import Pattern
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode

DRAFTED = 5
"""One in so many garments is drafted here, the others are of the folders."""
TIME_LIMIT_S = 10.0
"""For each step, of processor time: other work on the machine must not count."""
DRAPES = {"drape": 2}
"""Steps that drape twice: the mutated garment and the whole one."""
ITEM_LIMIT_S = {"encode": 120.0, "drape": 180.0}
"""Of the clock, after which a process that answers nothing is ended; its first item has more."""
MEMORY_LIMIT = 3 << 30
"""Of data of a process [bytes]."""
WHOLES_KEPT = 4
"""Whole garments of which a process remembers how they hang."""
MARGIN = 30.0
"""Cloth may not reach further over the crown of the head than this [cm]."""


@dataclass(frozen=True)
class Item:
    """One mutated garment, and how far it goes."""

    name: str
    """`encode`: through check, encode and decode; `drape_pattern`: through check and drape."""
    number: int
    seed: int
    files: tuple[Path, ...]


def mutated(item: Item) -> tuple[str, str, dict[str, Any], dict[str, Any], Expected]:
    """The mutation, the source, the specification before and after it, and what is expected."""
    rng = np.random.default_rng([item.seed, item.number])
    whole, source = _whole(item, rng)
    names = list(MUTATIONS)
    name = names[item.number % len(names)]
    spec = copy.deepcopy(whole)
    expected = MUTATIONS[name](spec, rng)
    return name, source, whole, spec, expected


def _whole(item: Item, rng: np.random.Generator) -> tuple[dict[str, Any], str]:
    """A garment before its mutation, without what only our own files hold."""
    while True:
        drawn = _drawn(item, rng)
        if isinstance(drawn, tuple):
            kind, index = drawn
            pattern = next(sample(kind, 1, item.seed, first=index)).pattern
            source = f"{kind} {index}"
        else:
            source = "/".join(drawn.parts[-2:])
            try:
                pattern = read_pattern(drawn)[0]
            except GarmentImageError:
                continue
        spec = pattern_to_spec(pattern)
        spec.pop("garmentimage", None)
        return spec, source


def _drawn(item: Item, rng: np.random.Generator) -> Path | tuple[str, int]:
    """A file, or a kind and the index of its sample."""
    if item.files and rng.integers(DRAFTED) > 0:
        return item.files[int(rng.integers(len(item.files)))]
    kinds = list(KINDS)
    return kinds[int(rng.integers(len(kinds)))], int(rng.integers(10_000))


def measured(item: Item) -> dict[str, Any]:
    """The record of one garment."""
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_LIMIT, MEMORY_LIMIT))
    mutation, source, whole, spec, expected = mutated(item)
    told: dict[str, Any] = {"mutation": mutation, "source": source, "what": expected.what}
    clock = time.process_time()
    try:
        pattern = _read(spec)
        told |= (_encoded if item.name == "encode" else _draped)(whole, pattern, expected)
    except GarmentImageError as error:
        told |= {"outcome": type(error).__name__, "why": str(error)[:300]}
    except Exception as error:
        told |= {"outcome": "CRASH", "why": f"{type(error).__name__}: {error}"[:300]}
    told["seconds"] = round(time.process_time() - clock, 2)
    if told["seconds"] > TIME_LIMIT_S * DRAPES.get(item.name, 1):
        told["slow"] = True
    return told


def _read(spec: dict[str, Any]) -> Pattern:
    """As from a file by others."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "pattern.json")
        path.write_text(json.dumps(spec), encoding="utf-8")
        return read_pattern(path)[0]


def _encoded(whole: dict[str, Any], pattern: Pattern, expected: Expected) -> dict[str, Any]:
    found = decode(encode(pattern))
    result = compare_patterns(pattern, found)
    if not result.success and expected.same:
        result = compare_patterns(_read(whole), found)
    if result.success:
        return {"outcome": "same"}
    return {"outcome": "WRONG", "why": "; ".join(result.reasons)[:300]}


def _draped(whole: dict[str, Any], pattern: Pattern, expected: Expected) -> dict[str, Any]:
    worn = drape_pattern(pattern)
    if worn.report.faults:
        why = "; ".join(worn.report.faults)[:300]
        if expected.near is None:
            return {"outcome": "fault", "why": why}
        alike = _hung(json.dumps(whole)) is None
        return {"outcome": "fault, as the whole" if alike else "fault, not the whole", "why": why}
    crown = float(worn.body.vertices[:, 1].max())
    top = float(worn.points[:, 1].max())
    if not expected.worn:
        return {"outcome": "WRONG", "why": "worn, although nobody can say where"}
    if top > crown + MARGIN:
        return {"outcome": "WRONG", "why": f"its top is {top:.0f} cm high"}
    if expected.near is None:
        return {"outcome": "well, not compared"}
    best = _hung(json.dumps(whole))
    if best is None:
        return {"outcome": "well, not compared"}
    middle, highest = best
    apart = float(np.linalg.norm(worn.points.mean(axis=0) - middle))
    higher = abs(top - highest)
    if max(apart, higher) > expected.near:
        why = f"lies {apart:.1f} cm from where the whole garment lies, its top {higher:.1f} cm"
        return {"outcome": "WRONG", "why": why}
    return {"outcome": "well"}


@lru_cache(maxsize=WHOLES_KEPT)
def _hung(spec: str) -> tuple[np.ndarray, float] | None:
    """Middle and height of a garment where it hangs [cm]; None where it does not hang well."""
    try:
        worn = drape_pattern(_read(json.loads(spec)))
    except GarmentImageError:
        return None
    return (
        None if worn.report.faults else (worn.points.mean(axis=0), float(worn.points[:, 1].max()))
    )


def items(name: str, args: argparse.Namespace, files: tuple[Path, ...]) -> Iterator[Item]:
    """In the order of their garments, so that each whole garment is draped once or twice."""
    found = (Item(name, number, args.seed, files) for number in range(args.first, args.count))
    if args.only:
        found = (item for item in found if mutated(item)[0] in args.only)
    yield from sorted(
        found,
        key=lambda item: str(_drawn(item, np.random.default_rng([item.seed, item.number]))),
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--records", type=Path, required=True, help="folder, to continue from")
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--steps", nargs="+", choices=ITEM_LIMIT_S, default=list(ITEM_LIMIT_S))
    parser.add_argument("--only", nargs="+", choices=MUTATIONS, help="these mutations, not all")
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    files = tuple(
        path for folder in args.folders for path in sorted(folder.rglob("*.json"))
        if not path.name.endswith("manifest.json")
    )  # fmt: skip
    facts = provenance(args.folders)
    # The number of garments is left out, so that a run can be made longer.
    amounts = {"seed": args.seed, "commit": facts["commit"], "data": data_hash(args.folders)}
    records = Records(args.records, amounts, {})
    counts: dict[str, dict[str, Counter]] = {}
    bad: list[dict[str, Any]] = []
    for name in args.steps:
        found = records.gather(
            list(items(name, args, files)),
            measured,
            workers=args.workers,
            time_limit=ITEM_LIMIT_S[name],
            progress=_progress(name),
        )
        counts[name] = _counted(found, bad)
    result = {
        **facts,
        "seed": args.seed,
        "first": args.first,
        "count": args.count,
        **({"only": args.only} if args.only else {}),
        "files": len(files),
        **{name: {m: dict(c) for m, c in by.items()} for name, by in counts.items()},
        "bad": bad,
    }
    for name, by in counts.items():
        print(name)
        for mutation, outcomes in sorted(by.items()):
            print(f"  {mutation:20}", ", ".join(f"{o} {n}" for o, n in outcomes.most_common()))
    for each in bad:
        print(each)
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return int(bool(bad))


def _counted(
    found: dict[Item, dict[str, Any]], bad: list[dict[str, Any]]
) -> dict[str, Counter[str]]:
    """Outcomes by mutation; what must not be is added to `bad`."""
    by: dict[str, Counter[str]] = defaultdict(Counter)
    for item, record in found.items():
        if "lost" in record:
            mutation, source, _, _, expected = mutated(item)
            outcome = "HANG" if "longer" in record["lost"] else "CRASH"
            record = {
                "mutation": mutation, "source": source, "what": expected.what,
                "outcome": outcome, "why": record["lost"],
            }  # fmt: skip
        by[record["mutation"]][record["outcome"]] += 1
        if record.get("slow"):
            by[record["mutation"]]["slow"] += 1
        if record["outcome"].isupper():
            bad.append({"step": item.name, "number": item.number, **record})
    return by


def _progress(name: str) -> Any:
    def tell(done: int, of: int) -> None:
        if done % 100 == 0 or done == of:
            print(f"{name}: {done} of {of}", file=sys.stderr, flush=True)

    return tell


if __name__ == "__main__":
    raise SystemExit(main())
