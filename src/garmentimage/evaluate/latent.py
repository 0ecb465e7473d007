"""Evaluation of latent spaces: reconstruction, interpolation and edits (Section 4.1).

All garments are held out: those of pairs come from the test split, those of edits from a seed that
no dataset uses. Records are written to a folder one by one, a file for each stage and network, so
that an interrupted run resumes.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.dataset import dataset_hash, parse_patterns, read_rows, read_summary
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
FIGURES = {
    "reconstruction": ("overlap", "graph", "valid"),
    "interpolation": ("changes", "outline jump", "silhouette jump"),
    "edits": ("intended", "overlap", "valid"),
}
"""Figures of each stage, beside those that are counted."""


@dataclass(frozen=True)
class Candidate:
    """A network with a level of repair."""

    name: str
    folder: str
    """Empty: GarmentImages as they are, without a network."""
    data: str
    """The dataset that it was trained on, whose test split is used."""
    level: RepairLevel | None
    """Of the raster network; None for the vector network."""


@dataclass(frozen=True)
class LatentItem:
    """One measurement."""

    stage: str
    candidate: Candidate
    amounts: LatentAmounts
    recipe: str
    number: int

    @property
    def name(self) -> str:
        """File of its record."""
        return f"{self.stage}-{self.candidate.name}"


def evaluate_latent(
    networks: Sequence[Candidate],
    recipe: str,
    folder: Path,
    amounts: LatentAmounts = LatentAmounts(),  # noqa: B008 - frozen
    *,
    workers: int = 2,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> dict[str, Any]:
    """Evaluate networks on the same garments.

    Args:
        networks: to evaluate.
        recipe: of the datasets; it determines the edits.
        folder: where records are written; a run that was interrupted resumes.
        amounts: numbers of garments, pairs and edits.
        workers: processes.
        progress: called with the number of items that are complete, and of all.

    Returns:
        By network and stage, figures with intervals of 95 %.

    Raises:
        LearnError: a network cannot be read, the test split has too few garments, or the folder
            holds records of other networks, data or amounts.
    """
    _check(networks, recipe, amounts)
    kept = Records(folder, asdict(amounts), {each.name: _fingerprint(each) for each in networks})
    counts = {
        "reconstruction": amounts.garments,
        "interpolation": amounts.pairs,
        "edits": amounts.triplets * len(EDITS[recipe]),
    }
    items = [
        LatentItem(stage, candidate, amounts, recipe, number)
        for stage in FIGURES
        for candidate in networks
        for number in range(counts[stage])
    ]
    records = kept.gather(
        items, score_latent_item, workers=workers, time_limit=TIME_LIMIT_S, progress=progress
    )
    return {
        candidate.name: {
            stage: summarise_latent(
                stage, [records[i] for i in items if (i.stage, i.candidate) == (stage, candidate)]
            )
            for stage in FIGURES
        }
        for candidate in networks
    }


def _check(networks: Sequence[Candidate], recipe: str, amounts: LatentAmounts) -> None:
    """Try every network on a garment, and check that there are enough garments and types."""
    example = draw_triplets(recipe, 1)[0].a
    for candidate in networks:
        codec = load_codec(candidate)
        try:
            codec.decode(codec.latents([example])[0])
        except GarmentImageError as error:
            raise LearnError(f"{shown_path(candidate.folder)}: {error}") from None
    for data in {candidate.data for candidate in networks}:
        _, types = _test_split(data)
        counts = Counter(types)
        if len(counts) < 2 or max(counts.values()) < 2 or len(types) < amounts.garments:
            raise LearnError(
                f"{shown_path(data)}: its test split has {len(types)} garments of {len(counts)} "
                f"types; at least {amounts.garments} of two types are needed, two of one type"
            )


def _fingerprint(candidate: Candidate) -> dict[str, str]:
    """Hashes that identify a network's records."""
    return {
        "weights_sha256": weights_hash(Path(candidate.folder)) if candidate.folder else "",
        "data_sha256": dataset_hash(Path(candidate.data)),
    }


def score_latent_item(item: LatentItem) -> dict[str, Any]:
    """The record of an item."""
    codec = load_codec(item.candidate)
    if item.stage == "reconstruction":
        return _reconstruction_record(codec, _held_out(item)[item.number])
    if item.stage == "interpolation":
        a, b, kind = draw_pairs(item.candidate.data, item.amounts.pairs)[item.number]
        return {"kind": kind, **_interpolation_record(codec, a, b)}
    return _edit_record(codec, draw_triplets(item.recipe, item.amounts.triplets)[item.number])


def _reconstruction_record(codec: Codec, pattern: Pattern) -> dict[str, Any]:
    found = _measure_step(codec.decode(codec.latents([pattern])[0]))
    return {
        "overlap": panel_overlap(pattern, found.pattern),
        "graph": same_graph(pattern, found.pattern),
        "valid": found.valid,
        "fault": found.fault,
    }


def _interpolation_record(codec: Codec, a: Pattern, b: Pattern) -> dict[str, Any]:
    start, end = codec.latents([a, b])
    steps = [
        _measure_step(codec.decode(start + share * (end - start)))
        for share in np.linspace(0, 1, INTERPOLATION_STEPS)
    ]
    patterns = [one.pattern for one in steps if one.pattern is not None]
    worn = [one.silhouette for one in steps if one.silhouette is not None]
    topologies = [one.topology for one in steps]
    return {
        "valid": [one.valid for one in steps],
        "faults": [one.fault for one in steps],
        "changes": sum(x != y for x, y in pairwise(topologies)),
        "outline jump": _jump([outline_distance(x, y) for x, y in pairwise(patterns)]),
        "silhouette jump": _jump([silhouette_distance(x, y) for x, y in pairwise(worn)]),
    }


def _edit_record(codec: Codec, triplet: Triplet) -> dict[str, Any]:
    a, b, c = codec.latents([triplet.a, triplet.b, triplet.c])
    pushed = edit(codec, a, b, c)
    best = settled = _score_edit(pushed.garment, triplet)
    if pushed.strength != 1:
        settled = _score_edit(edit(codec, a, b, c, strengths=(1.0,)).garment, triplet)
    plain = edit(codec, a, b, c, reprojections=0, strengths=(1.0,))
    return {
        "edit": triplet.edit.name,
        "settled and pushed": best,
        "settled": settled,
        "as in the paper": _score_edit(plain.garment, triplet),
    }


def _score_edit(step: DecodedGarment, triplet: Triplet) -> dict[str, Any]:
    found = _measure_step(step)
    same = found.topology == _topology(triplet.truth)
    return {
        "intended": same,
        "becomes": _outcome(found, triplet),
        "overlap": panel_overlap(triplet.truth, found.pattern) if same else None,
        "valid": found.valid,
        "fault": found.fault,
    }


def _outcome(found: MeasuredGarment, triplet: Triplet) -> str:
    """The garment whose topology the result of an edit has."""
    if not found.topology:
        return "no garment"
    names = {
        "intended": triplet.truth,
        "as C, unchanged": triplet.c,
        "as B": triplet.b,
        "as A": triplet.a,
    }
    return next((n for n, p in names.items() if found.topology == _topology(p)), "another")


def _topology(pattern: Pattern) -> str:
    return measure_garment(pattern, worn=False).topology


def _measure_step(step: DecodedGarment) -> MeasuredGarment:
    return measure_garment(step.pattern, step.faults[0] if step.faults else "")


def _jump(steps: Sequence[float]) -> float | None:
    """Largest step over the mean step; 1 for uniform steps."""
    return float(np.max(steps) / np.mean(steps)) if len(steps) and np.mean(steps) > 0 else None


@cache
def load_codec(candidate: Candidate) -> Codec:
    """A network, loaded once in each process."""
    if not candidate.folder:
        return PlainCodec(int(read_summary(Path(candidate.data))["grid"]))
    if candidate.level is None:
        return VectorCodec(Path(candidate.folder))
    return RasterCodec(LatentSpace.load(candidate.folder), candidate.level)


@cache
def _test_split(data: str) -> tuple[list[Pattern], list[str]]:
    rows = list(read_rows(data, "test", "type", "pattern"))
    return parse_patterns([text for _, text in rows], data), [name for name, _ in rows]


def _held_out(item: LatentItem) -> list[Pattern]:
    patterns, _ = _test_split(item.candidate.data)
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
    summary: dict[str, Any] = {"measured": len(found), "lost": len(records) - len(found)}
    if not found:
        return summary
    for group, rows in _groups(stage, found):
        if "becomes" in rows[0]:
            summary[f"{group}becomes"] = dict(Counter(row["becomes"] for row in rows).most_common())
        for name, values in _values(stage, rows):
            known = [v for v in values if v is not None]
            if known:
                summary[f"{group}{name}"] = asdict(interval(known))
    return summary


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
            for variant in [key for key in rows[0] if key != "edit"]:
                yield f"{edit}, {variant}: ", [row[variant] for row in rows]


def _values(
    stage: str, rows: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[str, list[float | None]]]:
    if stage == "interpolation":
        yield "valid steps", [float(np.mean(row["valid"])) for row in rows]
    for name in FIGURES[stage]:
        yield name, [row[name] for row in rows]
