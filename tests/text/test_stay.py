"""Where the picture of a garment stays while a text changes the rest."""

import numpy as np
import pytest
import torch

import garmentimage as gi
from garmentimage.draft.kinds import draft
from garmentimage.text.guidance import descent
from garmentimage.text.stay import staying

DRESS = draft("one-panel-dress", cutout="none", body_length=45)
SLEEVED = draft(
    "one-panel-dress", cutout="none", body_length=45, sleeves="set-in", sleeve_length=0.9
)
LONGER = draft("one-panel-dress", cutout="none", body_length=80)


def cloth(pattern) -> np.ndarray:
    """Pixels of a worn garment where cloth is seen, the lowest row first."""
    return gi.photograph(gi.drape_pattern(pattern), size=64).silhouette[::-1] > 0.5


@pytest.mark.parametrize(("touched", "other"), [("sleeves", SLEEVED), ("below the waist", LONGER)])
def test_garments_that_differ_in_what_a_text_touches_differ_mostly_where_nothing_is_held(
    touched, other
):
    changed = cloth(DRESS) != cloth(other)
    assert changed.sum() > 60
    assert changed[staying(touched, 64)].sum() < 0.4 * changed.sum()


class Pushing:
    """A guidance to which all should be white."""

    def start(self, pictures, said, further):
        pass

    def gradient(self, pictures, text, done):
        return pictures - 1


def test_what_is_held_stays_while_the_rest_goes_where_it_is_pushed():
    held = torch.zeros(8, 8)
    held[4:] = 5.0
    ends = descent(
        torch.zeros(3 * 8 * 8),
        lambda z: (0.5 + 0.5 * z + 0.1 * z.sum(1, keepdim=True) / 10).reshape(-1, 3, 8, 8),
        Pushing(),
        "white",
        steps=300,
        rate=0.02,
        pull=0.0,
        held=held,
    )
    drawn = (0.5 + 0.5 * ends + 0.1 * ends.sum() / 10).reshape(3, 8, 8)
    assert (drawn[:, 4:] - 0.5).abs().max() < 0.05 < 0.4 < (drawn[:, :4] - 0.5).abs().min()
