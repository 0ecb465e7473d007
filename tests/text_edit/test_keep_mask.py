"""Where the picture of a garment is kept while a text changes the rest."""

import numpy as np
import pytest
import torch

import garmentimage as gi
from garmentimage.draft.kind import draft_pattern
from garmentimage.text_edit.editor import run_edit
from garmentimage.text_edit.goal import keep_mask
from garmentimage.text_edit.guidance import optimise_latent
from tests.text_edit.fakes import PixelDecoder, TowardsWhite

DRESS = draft_pattern("one-panel-dress", cutout="none", body_length=45)
SLEEVED = draft_pattern(
    "one-panel-dress", cutout="none", body_length=45, sleeves="set-in", sleeve_length=0.9
)
LONGER = draft_pattern("one-panel-dress", cutout="none", body_length=80)


def cloth(pattern) -> np.ndarray:
    """Pixels of a worn garment where cloth is seen, the lowest row first."""
    return gi.photograph(gi.drape_pattern(pattern), size=64).silhouette[::-1] > 0.5


@pytest.mark.parametrize(("region", "other"), [("sleeves", SLEEVED), ("below the waist", LONGER)])
def test_pictures_of_garments_that_differ_in_a_region_differ_mostly_outside_its_mask(region, other):
    changed = cloth(DRESS) != cloth(other)
    assert changed.sum() > 60
    assert changed[keep_mask(region, 64)].sum() < 0.4 * changed.sum()


def test_weighted_pixels_are_kept_while_the_rest_follows_the_guidance():
    held = torch.zeros(8, 8)
    held[4:] = 5.0
    ends = optimise_latent(
        torch.zeros(3 * 8 * 8),
        lambda z: (0.5 + 0.5 * z + 0.1 * z.sum(1, keepdim=True) / 10).reshape(-1, 3, 8, 8),
        TowardsWhite(),
        "white",
        steps=300,
        learning_rate=0.02,
        distance_weight=0.0,
        keep_weight=held,
    )
    drawn = (0.5 + 0.5 * ends + 0.1 * ends.sum() / 10).reshape(3, 8, 8)
    assert (drawn[:, 4:] - 0.5).abs().max() < 0.05 < 0.4 < (drawn[:, :4] - 0.5).abs().min()


@pytest.mark.parametrize("region", ["sleeves", "below the waist"])
def test_an_edit_keeps_other_regions_and_more_so_with_less_strength(region):
    pictures = PixelDecoder()
    kept = torch.from_numpy(keep_mask(region, 8))

    def changes(region, strength):
        z = run_edit(
            torch.zeros(3 * 8 * 8), pictures, TowardsWhite(), "white", "",
            strength=strength, steps=100, region=region,
        )  # fmt: skip
        change = pictures.draw(z)[0] - 0.5
        return float(change[:, kept].mean()), float(change[:, ~kept].mean())

    free, held, weakly = changes(None, 1.0), changes(region, 1.0), changes(region, 4.0)
    assert held[0] < 0.8 * weakly[0] < 0.8 * free[0]
    assert held[1] == pytest.approx(free[1], abs=0.02)
