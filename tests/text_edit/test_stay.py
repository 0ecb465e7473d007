"""Where the picture of a garment stays while a text changes the rest."""

import numpy as np
import pytest
import torch

import garmentimage as gi
from garmentimage.draft.kinds import draft_pattern
from garmentimage.text_edit.editor import run_edit
from garmentimage.text_edit.guidance import optimise_latent
from garmentimage.text_edit.keep_mask import keep_mask
from tests.text_edit.fakes import PixelDecoder, TowardsWhite

DRESS = draft_pattern("one-panel-dress", cutout="none", body_length=45)
SLEEVED = draft_pattern(
    "one-panel-dress", cutout="none", body_length=45, sleeves="set-in", sleeve_length=0.9
)
LONGER = draft_pattern("one-panel-dress", cutout="none", body_length=80)


def cloth(pattern) -> np.ndarray:
    """Pixels of a worn garment where cloth is seen, the lowest row first."""
    return gi.photograph(gi.drape_pattern(pattern), size=64).silhouette[::-1] > 0.5


@pytest.mark.parametrize(("touched", "other"), [("sleeves", SLEEVED), ("below the waist", LONGER)])
def test_garments_that_differ_in_what_a_text_touches_differ_mostly_where_nothing_is_held(
    touched, other
):
    changed = cloth(DRESS) != cloth(other)
    assert changed.sum() > 60
    assert changed[keep_mask(touched, 64)].sum() < 0.4 * changed.sum()


def test_what_is_held_stays_while_the_rest_goes_where_it_is_pushed():
    held = torch.zeros(8, 8)
    held[4:] = 5.0
    ends = optimise_latent(
        torch.zeros(3 * 8 * 8),
        lambda z: (0.5 + 0.5 * z + 0.1 * z.sum(1, keepdim=True) / 10).reshape(-1, 3, 8, 8),
        TowardsWhite(),
        "white",
        steps=300,
        rate=0.02,
        pull=0.0,
        held=held,
    )
    drawn = (0.5 + 0.5 * ends + 0.1 * ends.sum() / 10).reshape(3, 8, 8)
    assert (drawn[:, 4:] - 0.5).abs().max() < 0.05 < 0.4 < (drawn[:, :4] - 0.5).abs().min()


@pytest.mark.parametrize("touched", ["sleeves", "below the waist"])
def test_an_edit_holds_what_its_text_does_not_touch_and_more_so_with_less_strength(touched):
    pictures = PixelDecoder()
    staying_now = torch.from_numpy(keep_mask(touched, 8))

    def changes(touched, strength):
        z = run_edit(
            torch.zeros(3 * 8 * 8), pictures, TowardsWhite(), "white", "",
            strength=strength, steps=100, touched=touched,
        )  # fmt: skip
        change = pictures.draw(z)[0] - 0.5
        return float(change[:, staying_now].mean()), float(change[:, ~staying_now].mean())

    free, held, weakly = changes(None, 1.0), changes(touched, 1.0), changes(touched, 4.0)
    assert held[0] < 0.8 * weakly[0] < 0.8 * free[0]
    assert held[1] == pytest.approx(free[1], abs=0.02)
