"""Ways through a latent space: between two garments, along an edit, and at random (Section 4.1)."""

from collections.abc import Iterator

import numpy as np

from garmentimage.dataset.recipe import recipe
from garmentimage.dataset.row import draw, task_of
from garmentimage.draft.parameters import near
from garmentimage.errors import LearnError, quoted
from garmentimage.explore.space import Latent, LatentSpace, Step
from garmentimage.pattern.model import Pattern
from garmentimage.raster.image import GarmentImage

STEPS = 9
SETTLE = 2
"""Times that an edited garment is decoded and encoded again; chosen on validation garments."""
SETTLE_LIMIT = 20
STEP_LIMITS = (2, 200)
MOST_DRAWS = 20
"""A garment that is rejected so often is given up."""

Source = Pattern | GarmentImage


def interpolate(space: LatentSpace, a: Source, b: Source, steps: int = STEPS) -> list[Step]:
    """Garments on the straight way from `a` to `b`, both ends among them.

    Raises:
        LearnError: a number of steps out of `STEP_LIMITS`, or a garment that the network does
            not take.
    """
    low, high = STEP_LIMITS
    if not low <= steps <= high:
        raise LearnError(f"{steps} steps; give {low} to {high}")
    start, end = space.encode(a), space.encode(b)
    return [space.step(_between(start, end, share)) for share in np.linspace(0, 1, steps)]


def transfer(space: LatentSpace, a: Source, b: Source, c: Source, *, settle: int = SETTLE) -> Step:
    """What `c` becomes by the edit that makes `b` of `a`: C + (B - A), settled.

    Args:
        space: the network.
        a: a garment without what is added.
        b: the same with it.
        c: the garment that it is added to.
        settle: times that the sum is settled (`LatentSpace.settled`); 0 is the paper's arithmetic.

    Raises:
        LearnError: `settle` out of 0 to `SETTLE_LIMIT`, or a garment that the network does not
            take.
    """
    if not 0 <= settle <= SETTLE_LIMIT:
        raise LearnError(f"settled {settle} times; give 0 to {SETTLE_LIMIT}")
    z = space.encode(c) + (space.encode(b) - space.encode(a))
    return space.step(space.settled(z, settle))


def generate(
    space: LatentSpace, count: int, seed: int = 0, *, type_name: str | None = None
) -> Iterator[Step]:
    """New garments, each like those of one type, drawn from the normal distribution of its latents.

    Garment k of a seed is the same however many are drawn. One that is no valid garment is drawn
    again.

    Raises:
        LearnError: there is no such type, or a number that will not do.
    """
    types = tuple(sorted(set(space.garments.types)))
    if type_name is not None and type_name not in types:
        raise LearnError(f"the network knows no type {quoted(type_name)}; {near(type_name, types)}")
    if count < 1 or seed < 0:
        raise LearnError(f"{count} garments of seed {seed}; give 1 or more, and a seed from 0")
    for number in range(count):
        random = np.random.default_rng([seed, number])
        name = type_name or types[int(random.integers(len(types)))]
        for _ in range(MOST_DRAWS):
            step = space.step(_drawn(space, name, random))
            if not step.faults:
                break
        yield step


def nearest(space: LatentSpace, source: Source, count: int = 5) -> list[tuple[str, float, Pattern]]:
    """The nearest garments that the network was trained on, among those that it knows by heart.

    Returns:
        Id of the row, distance in the latent space, and the garment itself, drafted again.
    """
    if not 1 <= count <= len(space.garments.ids):
        raise LearnError(f"{count} garments; give 1 to {len(space.garments.ids)}")
    apart = np.linalg.norm(space.garments.latents - space.encode(source), axis=1)
    found = np.argsort(apart, kind="stable")[:count]
    chosen = recipe(str(space.config["recipe"]))
    return [
        (
            space.garments.ids[k],
            float(apart[k]),
            draw(task_of(chosen, space.garments.ids[k], int(space.config["seed"]))).pattern,
        )
        for k in found
    ]


def _between(start: Latent, end: Latent, share: float) -> Latent:
    return ((1 - share) * start + share * end).astype(np.float32)


def _drawn(space: LatentSpace, name: str, random: np.random.Generator) -> Latent:
    here = space.garments.latents[[each == name for each in space.garments.types]]
    spread = np.linalg.cholesky(np.cov(here.T) + 1e-6 * np.eye(here.shape[1]))
    return (here.mean(0) + spread @ random.standard_normal(here.shape[1])).astype(np.float32)
