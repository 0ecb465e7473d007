"""Operations in a latent space: interpolation, edits, sampling, neighbours (paper, Section 4.1)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32

from garmentimage.dataset import draft_garment, load_recipe, task_from_id
from garmentimage.errors import LearnError, check_type, quoted
from garmentimage.latent.space import LatentSpace
from garmentimage.networks import DecodedGarment, Latent, topology_or_empty
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage
from garmentimage.system import did_you_mean

STEPS = 9
"""Garments of an interpolation."""
REPROJECTIONS = 2
"""Times that an edited garment is reprojected; chosen on validation garments."""
MAX_REPROJECTIONS = 20
STEP_LIMITS = (2, 200)
"""Fewest and most garments of an interpolation."""
MAX_GARMENTS = 200
"""Of one call."""
MAX_DRAWS = 20
"""Draws of a garment; the last is taken as it is."""

STRENGTHS = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0)
"""Of an edit: the first that changes the topology is taken, where the edit should change it; chosen
on validation garments."""
MAX_STRENGTH = 10.0

Source = Pattern | GarmentImage


@runtime_checkable
class Editable(Protocol):
    """A space whose latent vectors are garments."""

    def reproject(self, z: Latent, times: int) -> Latent:
        """See `LatentSpace.reproject`."""

    def decode(self, z: Latent) -> DecodedGarment:
        """The garment of a latent vector."""


@dataclass(frozen=True)
class EditedGarment:
    """The result of an edit."""

    garment: DecodedGarment
    strength: float
    """Factor of B - A."""

    @property
    def title(self) -> str:
        """The edit as a sum."""
        return f"C + {'' if self.strength == 1 else f'{self.strength:g} '}(B - A)"


def interpolate(
    space: LatentSpace, a: Source, b: Source, steps: int = STEPS
) -> list[DecodedGarment]:
    """Garments at equal distances on the straight line from `a` to `b`, both included.

    Raises:
        LearnError: steps outside `STEP_LIMITS`, or a garment that the network does not take.
    """
    check_type(space, LatentSpace, "LatentSpace.load(name) gives one")
    low, high = STEP_LIMITS
    if not low <= steps <= high:
        raise LearnError(f"{steps} steps; give {low} to {high}")
    start, end = space.encode(a), space.encode(b)
    return [
        space.decode(((1 - share) * start + share * end).astype(np.float32))
        for share in np.linspace(0, 1, steps)
    ]


def transfer(
    space: LatentSpace,
    a: Source,
    b: Source,
    c: Source,
    *,
    reprojections: int = REPROJECTIONS,
    strengths: Sequence[float] = STRENGTHS,
) -> EditedGarment:
    """Apply to `c` the edit that turns `a` into `b`; see `edit`.

    Raises:
        LearnError: `reprojections` outside 0 to `MAX_REPROJECTIONS`, strengths outside 0 to
            `MAX_STRENGTH` or none, or a garment that the network does not take.
    """
    check_type(space, LatentSpace, "LatentSpace.load(name) gives one")
    strengths = tuple(strengths)
    if not 0 <= reprojections <= MAX_REPROJECTIONS:
        raise LearnError(f"{reprojections} reprojections; give 0 to {MAX_REPROJECTIONS}")
    if not strengths or not all(0 < each <= MAX_STRENGTH for each in strengths):
        raise LearnError(f"strengths {list(strengths)}; give some above 0 and up to 10")
    return edit(
        space,
        *(space.encode(each) for each in (a, b, c)),
        reprojections=reprojections,
        strengths=strengths,
    )


def edit(
    space: Editable,
    a: Latent,
    b: Latent,
    c: Latent,
    *,
    reprojections: int = REPROJECTIONS,
    strengths: Sequence[float] = STRENGTHS,
) -> EditedGarment:
    """Latent arithmetic: C + s (B - A), reprojected, with the first strength s that changes C.

    The first strength is also taken where A and B have the same topology, and where no strength
    gives C another topology. `reprojections=0, strengths=[1]` is the arithmetic of the paper.

    Args:
        space: the network.
        a: latent vector of a garment without a feature.
        b: of the same garment with it.
        c: of the garment that the feature is added to.
        reprojections: of every sum (`LatentSpace.reproject`).
        strengths: those to try, in this order.
    """
    attempts = (
        EditedGarment(
            space.decode(space.reproject((c + s * (b - a)).astype(np.float32), reprojections)), s
        )
        for s in strengths
    )
    first = next(attempts)
    topologies = (topology_or_empty(space.decode(z).pattern) for z in (a, b, c))
    if len(strengths) == 1 or next(topologies) == next(topologies):
        return first
    unchanged = ("", next(topologies))
    tried = chain([first], attempts)
    return next((t for t in tried if topology_or_empty(t.garment.pattern) not in unchanged), first)


def generate(
    space: LatentSpace, count: int, seed: int = 0, *, type_name: str | None = None
) -> Iterator[DecodedGarment]:
    """New garments, sampled from a normal distribution of the latent vectors of a type.

    Each sample is reprojected, and drawn again where it is not valid or where its topology differs
    from that of the nearest stored garment of its type. Garment k of a seed does not depend on
    `count`.

    Args:
        space: the network.
        count: how many.
        seed: of the samples.
        type_name: garment type; None draws a type for each.

    Raises:
        LearnError: there is no such type, or `count` or `seed` is out of its range.
    """
    types = tuple(sorted(set(space.garments.types)))
    if type_name is not None and type_name not in types:
        raise LearnError(
            f"the network knows no type {quoted(type_name)}; {did_you_mean(type_name, types)}"
        )
    if not 1 <= count <= MAX_GARMENTS or seed < 0:
        raise LearnError(
            f"{count} garments of seed {seed}; give 1 to {MAX_GARMENTS}, and a seed from 0"
        )
    for number in range(count):
        random = np.random.default_rng([seed, number])
        name = type_name or types[int(random.integers(len(types)))]
        stored = space.garments.latents[[each == name for each in space.garments.types]]
        yield _sampled(space, stored, random)


def _sampled(
    space: LatentSpace, stored: Float32[np.ndarray, "n latent"], random: np.random.Generator
) -> DecodedGarment:
    """The first valid sample of `MAX_DRAWS`, or the last."""
    for _ in range(MAX_DRAWS):
        garment = space.decode(space.reproject(_normal_sample(stored, random), REPROJECTIONS))
        neighbour = stored[np.linalg.norm(stored - garment.z, axis=1).argmin()]
        topology = topology_or_empty(garment.pattern)
        if not garment.faults and topology == topology_or_empty(space.decode(neighbour).pattern):
            break
    return garment


def nearest(space: LatentSpace, source: Source, count: int = 5) -> list[tuple[str, float, Pattern]]:
    """The nearest training garments, among those that the network stores.

    Returns:
        Id of the row, distance in the latent space, and the garment, drafted again.

    Raises:
        LearnError: `count` is less than 1 or more than are stored.
    """
    if not 1 <= count <= len(space.garments.ids):
        raise LearnError(f"{count} garments; give 1 to {len(space.garments.ids)}")
    distances = np.linalg.norm(space.garments.latents - space.encode(source), axis=1)
    nearest_first = np.argsort(distances, kind="stable")[:count]
    recipe = load_recipe(str(space.config["recipe"]))
    return [
        (
            space.garments.ids[k],
            float(distances[k]),
            draft_garment(
                task_from_id(recipe, space.garments.ids[k], int(space.config["seed"]))
            ).pattern,
        )
        for k in nearest_first
    ]


def _normal_sample(latents: Float32[np.ndarray, "n latent"], random: np.random.Generator) -> Latent:
    """A sample of the normal distribution with the mean and covariance of these vectors."""
    size = latents.shape[1]
    # A little variance everywhere, as the covariance of few vectors is singular.
    root = np.linalg.cholesky(np.cov(latents.T) + 1e-6 * np.eye(size))
    sampled: Latent = (latents.mean(0) + root @ random.standard_normal(size)).astype(np.float32)
    return sampled
