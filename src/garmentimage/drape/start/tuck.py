"""Tucking in: what lies under a waistband is gathered to the width of the body there.

In reality a waistband presses loose cloth against the body. Here an outer item meets the inner one
as if it were hard, so that the inner one has to be narrow by itself.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body
from garmentimage.drape.girths import trunk_girth
from garmentimage.drape.mesh import Rest

ROOM = 0.92  # girth of the tucked cloth, as a share of the body's: it lies tight
STEP = 4.0  # distance of the levels at which body and cloth are measured [cm]


def tuck_in(rest: Rest, start: Float[np.ndarray, "vertex 3"], body: Body, level: float) -> Rest:
    """The cloth of a top with what lies lower than the waistband gathered round the body.

    Its vertices begin at `start`, flat in front of the body and behind it; the waistband that holds
    it is at the height `level` [cm].
    """
    # A length l with the level part w of its direction shrinks to l sqrt(1 - w (1 - s^2)), as if
    # all level distances became the share s.
    x, y, _ = start.T
    crotch = float(body.landmarks["crotch"][1]) if "crotch" in body.landmarks else -np.inf
    levels = np.arange(level, max(float(y.min()), crotch) - STEP, -STEP)
    shares = [_share(x[np.abs(y - at) < STEP], body, at) for at in levels]
    of_vertex = np.where(y < level, np.interp(y, levels[::-1], shares[::-1]), 1.0)
    share = of_vertex[rest.edges].max(axis=1)
    along = start[rest.edges[:, 1]] - start[rest.edges[:, 0]]
    level_part = 1.0 - along[:, 1] ** 2 / np.maximum((along**2).sum(axis=1), 1e-12)
    return replace(rest, length=rest.length * np.sqrt(1.0 - level_part * (1.0 - share**2)))


def _share(x: np.ndarray, body: Body, level: float) -> float:
    """Girth of the body as a share of the cloth's at some level, at most 1."""
    if not len(x):
        return 1.0
    return min(ROOM * trunk_girth(body, float(level)) / max(2 * float(np.ptp(x)), 1e-6), 1.0)
