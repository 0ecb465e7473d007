"""Where cloth passes through cloth, against a test of every pair."""

from itertools import combinations

import numpy as np
import pytest

from garmentimage.drape.verdict.intersections import crossing_count

SIDES = ((0, 1), (1, 2), (2, 0))


def meets(segment, triangle) -> bool:
    """Whether a segment goes through a triangle, by solving for the place where it does."""
    (p, q), (a, b, c) = segment, triangle
    share, u, v = np.linalg.solve(np.column_stack([p - q, b - a, c - a]), p - a)
    return 0 <= share <= 1 and u >= 0 and v >= 0 and u + v <= 1


def crossed_by_every_pair(points, faces) -> int:
    crossed = set()
    for f, g in combinations(range(len(faces)), 2):
        if set(faces[f]) & set(faces[g]):
            continue
        one, two = points[faces[f]], points[faces[g]]
        if any(meets(b[list(side)], a) for a, b in ((one, two), (two, one)) for side in SIDES):
            crossed |= {f, g}
    return len(crossed)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("spread", "shared"), [(1.0, 90), (2.5, 90), (4.0, 40)])
def test_crossings_are_those_of_every_pair_of_random_triangles(seed, spread, shared):
    """`shared` points for 30 triangles: with fewer than 90 some have corners in common."""
    random = np.random.default_rng(seed)
    middle = random.uniform(0, spread, (shared, 3))
    faces = random.permuted(np.arange(90) % shared)[: 30 * 3].reshape(30, 3)
    faces = faces[[len(set(face)) == 3 for face in faces.tolist()]]
    points = middle + random.normal(0, 0.5, (shared, 3))
    found = crossed_by_every_pair(points, faces)
    assert crossing_count(points, faces) == found
    assert found > 0


def test_crossings_do_not_depend_on_where_the_cloth_is():
    random = np.random.default_rng(9)
    points, faces = random.uniform(0, 2, (60, 3)), random.permutation(60).reshape(20, 3)
    count = crossing_count(points, faces)
    assert count > 0
    turned = points[:, [2, 0, 1]] * 16.0 + [512.0, -256.0, 64.0]
    assert crossing_count(turned, faces) == count
    order = random.permutation(20)
    assert crossing_count(points, faces[order]) == count


def test_sheets_that_lie_over_each_other_do_not_cross_and_a_fold_through_does():
    square = np.array([[0, 0, 0], [4, 0, 0], [4, 0, 4], [0, 0, 4]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    over = np.concatenate([square, square + np.array([0.3, 0.01, 0.2])])
    assert crossing_count(over, faces) == 0
    tilted = over.copy()
    tilted[5:7, 1] -= 1.0
    assert crossing_count(tilted, faces) == 4
