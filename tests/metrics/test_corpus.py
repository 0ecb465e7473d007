"""The judge and the sample on patterns by others."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from garmentimage.compare.comparison import compare_patterns
from garmentimage.compare.validation import pattern_faults
from garmentimage.pattern.files.spec import read_pattern
from tests.compare.garments import (
    renamed_panels,
    reordered,
    shifted_loops,
    split_edges,
    transformed_panel,
    turned_stitch,
    without_stitch,
)
from tests.corpus import corpus_sample, sample

pytestmark = [pytest.mark.corpus, pytest.mark.slow]

FEW = 40


@pytest.fixture(scope="module")
def patterns():
    return [read_pattern(path)[0] for path in corpus_sample(FEW)]


def test_every_pattern_is_valid_and_itself(patterns):
    for pattern in patterns:
        assert pattern_faults(pattern) == [], pattern.name
        result = compare_patterns(pattern, pattern)
        assert result.success, (pattern.name, result.reasons)
        assert result.seam_agreement == 1
        assert result.seam_length_deviation == 0
        assert min(result.iou.values()) > 0.9999


def test_every_pattern_written_otherwise_is_itself(patterns):
    rng = np.random.default_rng(0)
    for pattern in patterns:
        cuts = {s.a: rng.uniform(0.2, 0.8) for s in pattern.stitches[::2]}
        cuts |= {side: 0.5 for side in pattern.sides() if side not in pattern.partners}
        again = shifted_loops(split_edges(pattern, cuts), 2)
        again = renamed_panels(reordered(again, rng), lambda name: f"piece {name}")
        result = compare_patterns(pattern, again)
        assert result.success, (pattern.name, result.reasons)


def test_every_damaged_pattern_is_another(patterns):
    for number, pattern in enumerate(patterns):
        stitch = number % len(pattern.stitches)
        panel = pattern.panels[number % len(pattern.panels)].name
        damaged = {
            "a stitch less": without_stitch(pattern, stitch),
            "a stitch turned": turned_stitch(pattern, stitch),
            "a panel shrunk": transformed_panel(pattern, panel, np.eye(2) * 0.9),
            "a panel less": replace(
                pattern,
                panels=tuple(p for p in pattern.panels if p.name != panel),
                stitches=tuple(s for s in pattern.stitches if panel not in (s.a.panel, s.b.panel)),
            ),
        }
        for damage, other in damaged.items():
            result = compare_patterns(pattern, other)
            assert not result.success, (pattern.name, damage)
            assert result.reasons


def test_the_sample_is_spread_over_all_kinds():
    chosen = corpus_sample()
    assert len(chosen) == 200
    assert len({path.parent for path in chosen}) > 10
    assert chosen == corpus_sample()


def test_the_sample_is_proportional():
    files = [Path(f"/x/many/{k:03}.json") for k in range(90)]
    files += [Path(f"/x/few/{k}.json") for k in range(10)]
    chosen = sample(files, 20)
    assert len(chosen) == 20
    assert sum(path.parent.name == "few" for path in chosen) in (2, 3)
