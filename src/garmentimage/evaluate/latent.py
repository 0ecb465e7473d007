"""Exploring a latent space, measured: reconstruction, interpolation, edits (Section 4.1).

Every garment measured on is held out: those of pairs are of the test split, those of edits have a
seed that no dataset has. Records go to a folder as they come, a file for each stage and network,
and a run that was stopped goes on.
"""

import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.dataset import dataset_hash, read_summary
from garmentimage.errors import GarmentImageError, LearnError
from garmentimage.evaluate.amounts import LatentAmounts
from garmentimage.evaluate.codecs import Codec, PlainCodec, RasterCodec, VectorCodec
from garmentimage.evaluate.edit_triplets import EDITS, Triplet, sample_triplets
from garmentimage.evaluate.garment import (
    MeasuredGarment,
    measure_garment,
    outline_distance,
    panel_overlap,
    same_graph,
    silhouette_distance,
)
from garmentimage.evaluate.records import Records
from garmentimage.latent import LatentSpace, edit
from garmentimage.metrics import interval
from garmentimage.networks import DecodedGarment
from garmentimage.pattern import Pattern
from garmentimage.raster.repair import RepairLevel
from garmentimage.system import shown_path, weights_hash

INTERPOLATION_STEPS = 9
SEED = 20
TIME_LIMIT_S = 300.0
STAGES = ("reconstruction", "interpolation", "edits")


@dataclass(frozen=True)
class Candidate:
    """A network, at a level of repair."""

    name: str
    folder: str
    """Empty: GarmentImages as they are, without a network."""
    data: str
    """The dataset that it was trained on, whose test split is measured on."""
    level: RepairLevel | None
    """Of the raster network; None for the vector network."""


@dataclass(frozen=True)
class LatentItem:
    """One thing to measure."""

    stage: str
    judged: Candidate
    amounts: LatentAmounts
    recipe: str
    number: int

    @property
    def name(self) -> str:
        """Of the records that it is one of."""
        return f"{self.stage}-{self.judged.name}"


def evaluate_latent(
    networks: Sequence[Candidate],
    recipe: str,
    folder: Path,
    amounts: LatentAmounts = LatentAmounts(),  # noqa: B008 - frozen
    *,
    workers: int = 2,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, Any]:
    """Measure networks on the same garments, and sum up.

    Args:
        networks: what is measured.
        recipe: of the datasets; it has the edits.
        folder: where records go; gone on with.
        amounts: how many of each.
        workers: processes.
        progress: called with how many items are done, and of how many.

    Returns:
        By network and stage, figures with intervals of 95 %.

    Raises:
        LearnError: a network cannot be read, the test split has too few garments, or the folder
            holds records of others.
    """
    _check(networks, recipe, amounts)
    kept = Records(folder, asdict(amounts), {each.name: _fingerprint(each) for each in networks})
    counts = {
        "reconstruction": amounts.garments,
        "interpolation": amounts.pairs,
        "edits": amounts.triplets * len(EDITS[recipe]),
    }
    items = [
        LatentItem(stage, judged, amounts, recipe, number)
        for stage in STAGES
        for judged in networks
        for number in range(counts[stage])
    ]
    records = kept.gather(
        items, score_latent_item, workers=workers, time_limit=TIME_LIMIT_S, progress=progress
    )
    return {
        judged.name: {
            stage: summarise_latent(
                stage, [records[i] for i in items if (i.stage, i.judged) == (stage, judged)]
            )
            for stage in STAGES
        }
        for judged in networks
    }


def _check(networks: Sequence[Candidate], recipe: str, amounts: LatentAmounts) -> None:
    """Try every network on a garment, and whether there are pairs to draw."""
    example = draw_triplets(recipe, 1)[0].a
    for judged in networks:
        codec = load_codec(judged)
        try:
            codec.decode(codec.latents([example])[0])
        except GarmentImageError as error:
            raise LearnError(f"{shown_path(judged.folder)}: {error}") from None
    for data in {judged.data for judged in networks}:
        _, types = _test_split(data)
        counts = Counter(types)
        if len(counts) < 2 or max(counts.values()) < 2 or len(types) < amounts.garments:
            raise LearnError(
                f"{shown_path(data)}: its test split has {len(types)} garments of {len(counts)} "
                f"types; this takes {amounts.garments} or more, two types, and two of one type"
            )


def _fingerprint(judged: Candidate) -> dict[str, str]:
    """What tells a network's records from those of others."""
    return {
        "weights_sha256": weights_hash(Path(judged.folder)) if judged.folder else "",
        "data_sha256": dataset_hash(Path(judged.data)),
    }


def score_latent_item(item: LatentItem) -> dict[str, Any]:
    """The record of an item."""
    codec = load_codec(item.judged)
    if item.stage == "reconstruction":
        return _reconstruction_record(codec, _held_out(item)[item.number])
    if item.stage == "interpolation":
        a, b, kind = draw_pairs(item.judged.data, item.amounts.pairs)[item.number]
        return {"kind": kind, **_interpolation_record(codec, a, b)}
    return _edit_record(codec, draw_triplets(item.recipe, item.amounts.triplets)[item.number])


def _reconstruction_record(codec: Codec, pattern: Pattern) -> dict[str, Any]:
    found = _measure_latent(codec, codec.latents([pattern])[0])
    return {
        "overlap": panel_overlap(pattern, found.pattern),
        "graph": same_graph(pattern, found.pattern),
        "valid": found.valid,
        "fault": found.fault,
    }


def _interpolation_record(codec: Codec, a: Pattern, b: Pattern) -> dict[str, Any]:
    start, end = codec.latents([a, b])
    way = [
        _measure_latent(codec, start + share * (end - start))
        for share in np.linspace(0, 1, INTERPOLATION_STEPS)
    ]
    patterns = [one.pattern for one in way if one.pattern is not None]
    worn = [one.silhouette for one in way if one.silhouette is not None]
    topologies = [one.topology for one in way]
    return {
        "valid": [one.valid for one in way],
        "faults": [one.fault for one in way],
        "changes": sum(x != y for x, y in pairwise(topologies)),
        "outline jump": _jump([outline_distance(x, y) for x, y in pairwise(patterns)]),
        "silhouette jump": _jump([silhouette_distance(x, y) for x, y in pairwise(worn)]),
    }


def _edit_record(codec: Codec, triplet: Triplet) -> dict[str, Any]:
    a, b, c = codec.latents([triplet.a, triplet.b, triplet.c])
    pushed, plain = edit(codec, a, b, c), edit(codec, a, b, c, reprojections=0, strengths=(1.0,))
    told = {"settled and pushed": _score_edit(_measure_step(pushed.garment), triplet)}
    if pushed.strength == 1:
        told["settled"] = told["settled and pushed"]
    else:
        settled = edit(codec, a, b, c, strengths=(1.0,))
        told["settled"] = _score_edit(_measure_step(settled.garment), triplet)
    told["as in the paper"] = _score_edit(_measure_step(plain.garment), triplet)
    return {"edit": triplet.edit.name, **told}


def _score_edit(found: MeasuredGarment, triplet: Triplet) -> dict[str, Any]:
    same = found.topology == _topology(triplet.truth)
    return {
        "intended": same,
        "becomes": _outcome(found, triplet),
        "overlap": panel_overlap(triplet.truth, found.pattern) if same else None,
        "valid": found.valid,
        "fault": found.fault,
    }


def _outcome(found: MeasuredGarment, triplet: Triplet) -> str:
    """Whose topology the garment has after an edit."""
    if not found.topology:
        return "no garment"
    names = {"intended": triplet.truth, "as C, unchanged": triplet.c, "as B": triplet.b}
    names["as A"] = triplet.a
    return next((n for n, p in names.items() if found.topology == _topology(p)), "another")


def _topology(pattern: Pattern) -> str:
    return measure_garment(pattern, worn=False).topology


def _measure_latent(codec: Codec, z: np.ndarray) -> MeasuredGarment:
    return _measure_step(codec.decode(z))


def _measure_step(step: DecodedGarment) -> MeasuredGarment:
    return measure_garment(step.pattern, step.faults[0] if step.faults else "")


def _jump(steps: Sequence[float]) -> float | None:
    """Largest step over the mean one; 1 is perfectly even."""
    return float(np.max(steps) / np.mean(steps)) if len(steps) and np.mean(steps) > 0 else None


@cache
def load_codec(judged: Candidate) -> Codec:
    """A network, loaded once in each process."""
    if not judged.folder:
        return PlainCodec(int(read_summary(Path(judged.data))["grid"]))
    if judged.level is None:
        return VectorCodec(Path(judged.folder))
    return RasterCodec(LatentSpace.load(judged.folder), judged.level)


@cache
def _test_split(data: str) -> tuple[list[Pattern], list[str]]:
    from garmentimage.dataset import read_tables
    from garmentimage.pattern.files import pattern_from_spec

    patterns, types = [], []
    for table in read_tables(data, "test", ["type", "pattern"]):
        types += table["type"].to_pylist()
        patterns += [pattern_from_spec(json.loads(text)) for text in table["pattern"].to_pylist()]
    return patterns, types


def _held_out(item: LatentItem) -> list[Pattern]:
    patterns, _ = _test_split(item.judged.data)
    order = np.random.default_rng(SEED).permutation(len(patterns))
    return [patterns[k] for k in order[: item.amounts.garments]]


@cache
def draw_pairs(data: str, count: int) -> list[tuple[Pattern, Pattern, str]]:
    """Pairs of the test split, in turn within a type and across types."""
    patterns, types = _test_split(data)
    random = np.random.default_rng(SEED + 1)
    pairs: list[tuple[Pattern, Pattern, str]] = []
    while len(pairs) < count:
        i, j = random.choice(len(patterns), 2, replace=False)
        wanted = "across" if len(pairs) % 2 else "within"
        if (types[i] == types[j]) == (wanted == "within"):
            pairs.append((patterns[i], patterns[j], wanted))
    return pairs


@cache
def draw_triplets(recipe: str, count: int) -> list[Triplet]:
    """The triplets of all edits of a recipe, edit by edit."""
    return [each for edit in EDITS[recipe] for each in sample_triplets(edit, count)]


# --- Figures ----------------------------------------------------------------------------------


def summarise_latent(stage: str, records: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Figures of a stage, each with its interval of 95 %."""
    found = [record for record in records if "lost" not in record]
    told: dict[str, Any] = {"measured": len(found), "lost": len(records) - len(found)}
    if not found:
        return told
    for group, rows in _groups(stage, found):
        if "becomes" in rows[0]:
            told[f"{group}becomes"] = dict(Counter(row["becomes"] for row in rows).most_common())
        for name, values in _values(stage, rows):
            known = [v for v in values if v is not None]
            if known:
                told[f"{group}{name}"] = asdict(interval(known))
    return told


def _groups(
    stage: str, records: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[str, list[Mapping[str, Any]]]]:
    if stage == "reconstruction":
        yield "", list(records)
    elif stage == "interpolation":
        for kind in dict.fromkeys(record["kind"] for record in records):
            yield f"{kind}: ", [record for record in records if record["kind"] == kind]
    else:
        for edit in dict.fromkeys(record["edit"] for record in records):
            rows = [record for record in records if record["edit"] == edit]
            for way in [key for key in rows[0] if key != "edit"]:
                yield f"{edit}, {way}: ", [row[way] for row in rows]


def _values(
    stage: str, rows: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[str, list[float | None]]]:
    if stage == "interpolation":
        yield "valid steps", [float(np.mean(row["valid"])) for row in rows]
        for name in ("changes", "outline jump", "silhouette jump"):
            yield name, [row[name] for row in rows]
        return
    names = {
        "reconstruction": ("overlap", "graph", "valid"),
        "edits": ("intended", "overlap", "valid"),
    }
    for name in names[stage]:
        yield name, [row[name] for row in rows]


def describe_run(networks: Sequence[Candidate], amounts: LatentAmounts) -> dict[str, Any]:
    """What a result was measured on."""
    return {"networks": [asdict(each) for each in networks], "amounts": asdict(amounts)}
