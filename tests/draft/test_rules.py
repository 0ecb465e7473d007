"""What cannot be cut or worn is refused."""

import pytest

from garmentimage.draft import rules
from garmentimage.draft.panel import FRONT, lines, placed
from garmentimage.errors import DraftError
from garmentimage.geometry.curves import Bezier
from garmentimage.pattern.model import loop_from_curves

SQUARE = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))


def panel(*corners, holes=()):
    return placed(
        "front", lines("edge", *corners, corners[0]), FRONT, (0.0, 0.0, 10.0), holes=holes
    )


def diamond(size):
    corners = ((5 - size, 5.0), (5.0, 5 + size), (5 + size, 5.0), (5.0, 5 - size))
    ends = (*corners[1:], corners[0])
    return loop_from_curves([Bezier(a, (b,), b) for a, b in zip(corners, ends, strict=True)])


def test_a_simple_panel_can_be_cut():
    rules.check_outlines([panel(*SQUARE), panel(*SQUARE, holes=(diamond(3.0),))])


@pytest.mark.parametrize(
    "crossed",
    [
        panel(SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]),
        panel(*SQUARE[::-1]),
        panel(*SQUARE, holes=(diamond(6.0),)),
    ],
    ids=["bow tie", "clockwise", "hole over the edge"],
)
def test_a_panel_that_crosses_itself_is_refused(crossed):
    with pytest.raises(DraftError, match="do not go together: the outline of front crosses itself"):
        rules.check_outlines([panel(*SQUARE), crossed])


def test_a_neckline_stretches_a_little():
    rules.check_neck(50.0, 55.0)
    with pytest.raises(DraftError, match=r"the neckline is 40.0 cm round"):
        rules.check_neck(40.0, 55.0)


def test_a_sleeve_is_wider_than_the_arm():
    rules.check_sleeve(32.0, 28.0)
    with pytest.raises(DraftError, match=r"the sleeve is 29.0 cm round"):
        rules.check_sleeve(29.0, 28.0)


def test_a_leg_is_wider_than_the_thigh():
    rules.check_thigh(60.0, 55.0)
    with pytest.raises(DraftError, match=r"the leg is 55.0 cm round"):
        rules.check_thigh(55.0, 55.0)
