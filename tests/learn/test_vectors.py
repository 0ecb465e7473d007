"""Vectors, the baseline's form of a garment: what they keep, and what they cannot tell."""

import numpy as np
import pytest

from garmentimage.compare import match_panels, pattern_faults
from garmentimage.draft.sampling import sample
from garmentimage.errors import DecodeError, LearnError
from garmentimage.learn.data.pattern_vectors import (
    build_vocabulary,
    read_patterns,
    read_vocabulary,
    to_vectors,
    vertex_counts,
    vocabulary_from_json,
)

KINDS = {"one-panel-dress": {"cutout": "none"}, "top-pants": {}, "skirt": {}}


def garments(count, first=0):
    return [
        each.pattern
        for kind, fixed in KINDS.items()
        for each in sample(kind, count, 3, fixed=fixed, first=first)
    ]


KNOWN = garments(40)
WORDS = build_vocabulary(KNOWN)


def test_garments_of_a_known_topology_come_back():
    new = [p for p in garments(15, first=1000) if vertex_counts(p) in WORDS.topologies]
    assert len(new) > 20
    alike = []
    for pattern in new:
        again = WORDS.pattern(*WORDS.vectors(pattern))
        assert [p.name for p in again.panels] == sorted(p.name for p in pattern.panels)
        matching = match_panels(pattern, again, by_name=True)
        alike += [pair.iou for pair in matching.pairs]
        assert not pattern_faults(again)
    # One control point an edge, as the paper has it, cannot tell the S of a sleeve cap.
    assert np.mean(alike) > 0.97 and min(alike) > 0.8


def test_panels_that_no_topology_has_take_the_nearest_one():
    found = dict(vertex_counts(KNOWN[0])) | {"waistband_front": 4}
    assert WORDS.nearest(found) == vertex_counts(KNOWN[0])


def test_a_garment_without_panels_is_refused():
    numbers, there = WORDS.vectors(KNOWN[-1])
    with pytest.raises(DecodeError, match="hold no panel"):
        WORDS.pattern(numbers, np.zeros_like(there))


def test_panels_of_no_known_kind_are_refused():
    with pytest.raises(LearnError, match="cannot be encoded as vectors"):
        WORDS.vectors(next(sample("hoodie", 1, 0)).pattern)


def test_vectors_of_a_split_go_into_batches(data):
    patterns = read_patterns(data, "train")
    found = to_vectors(patterns, build_vocabulary(patterns))
    assert len(found) == 24
    assert found.numbers.shape[:3] == found.is_present.shape


def test_a_vocabulary_comes_back_from_its_text(data, tmp_path):
    words = build_vocabulary(read_patterns(data, "train"))
    assert vocabulary_from_json(words.to_json()) == words
    with pytest.raises(LearnError, match=r"words\.json: is missing or damaged"):
        read_vocabulary(tmp_path)
    (tmp_path / "words.json").write_text('{"panels": 3}')
    with pytest.raises(LearnError, match=r"words\.json: is missing or damaged"):
        read_vocabulary(tmp_path)
