"""Ways through a latent space: between two garments, along an edit, and at random (Section 4.1)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

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
REPROJECTIONS = 2
"""Times that an edited garment is decoded and encoded again; chosen on validation garments."""
MAX_REPROJECTIONS = 20
STEP_LIMITS = (2, 200)
MAX_GARMENTS = 200
"""That are drawn at a time."""
MAX_DRAWS = 20
"""A garment that is rejected so often is given up."""

STRENGTHS = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0)
"""Of an edit: the first that changes the topology is taken, where the edit should change it; chosen
on validation garments."""
MAX_STRENGTH = 10.0

Source = Pattern | GarmentImage


class Editable(Protocol):
    """What has points that are garments."""

    def reproject(self, z: Latent, times: int) -> Latent:
        """A point decoded and encoded again so many times."""

    def decode(self, z: Latent) -> DecodedGarment:
        """The garment at a point."""


@dataclass(frozen=True)
class EditedGarment:
    """A garment that was edited."""

    garment: DecodedGarment
    strength: float
    """Times B - A was added."""

    @property
    def title(self) -> str:
        """The edit as a sum."""
        return f"C + {'' if self.strength == 1 else f'{self.strength:g} '}(B - A)"


def interpolate(
    space: LatentSpace, a: Source, b: Source, steps: int = STEPS
) -> list[DecodedGarment]:
    """Garments on the straight way from `a` to `b`, both ends among them.

    Raises:
        LearnError: a number of steps out of `STEP_LIMITS`, or a garment that the network does
            not take.
    """
    check_type(space, LatentSpace, "LatentSpace.load(name) gives one")
    low, high = STEP_LIMITS
    if not low <= steps <= high:
        raise LearnError(f"{steps} steps; give {low} to {high}")
    start, end = space.encode(a), space.encode(b)
    return [space.decode(_between(start, end, share)) for share in np.linspace(0, 1, steps)]


def transfer(
    space: LatentSpace,
    a: Source,
    b: Source,
    c: Source,
    *,
    reprojections: int = REPROJECTIONS,
    strengths: Sequence[float] = STRENGTHS,
) -> EditedGarment:
    """What `c` becomes by the edit that makes `b` of `a`; see `edit`.

    Raises:
        LearnError: `reprojections` out of 0 to `MAX_REPROJECTIONS`, no strengths, or a garment that
        the network
            does not take.
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
    """C + s (B - A), settled, by the least strength s that makes another garment of C.

    Where A and B have the same topology the first strength is enough, and so it is where no
    strength changes that of C. `reprojections=0, strengths=[1]` is the arithmetic of the paper.

    Args:
        space: the network.
        a: latent vector of a garment without what is added.
        b: of the same with it.
        c: of the garment that it is added to.
        reprojections: times that a sum is decoded and encoded again (`LatentSpace.reproject`).
        strengths: those to try, in this order.
    """
    tried = (
        EditedGarment(
            space.decode(space.reproject((c + s * (b - a)).astype(np.float32), reprojections)), s
        )
        for s in strengths
    )
    first = next(tried)
    if len(strengths) == 1 or _topology(space.decode(a)) == _topology(space.decode(b)):
        return first
    unchanged = ("", _topology(space.decode(c)))
    while_same = (each for each in (first, *tried) if _topology(each.garment) not in unchanged)
    return next(while_same, first)


def generate(
    space: LatentSpace, count: int, seed: int = 0, *, type_name: str | None = None
) -> Iterator[DecodedGarment]:
    """New garments, each like those of one type, drawn from the normal distribution of its latents.

    Each is settled, and drawn again where it is no valid garment, or has another topology than the
    nearest garment of its type that the network knows. Garment k of a seed is the same however many
    are drawn.

    Raises:
        LearnError: there is no such type, or a number that will not do.
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
        here = space.garments.latents[[each == name for each in space.garments.types]]
        for _ in range(MAX_DRAWS):
            step = space.decode(space.reproject(_drawn(here, random), REPROJECTIONS))
            known = here[np.linalg.norm(here - step.z, axis=1).argmin()]
            if not step.faults and _topology(step) == _topology(space.decode(known)):
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
    chosen = load_recipe(str(space.config["recipe"]))
    return [
        (
            space.garments.ids[k],
            float(apart[k]),
            draft_garment(
                task_from_id(chosen, space.garments.ids[k], int(space.config["seed"]))
            ).pattern,
        )
        for k in found
    ]


def _topology(step: DecodedGarment) -> str:
    return topology_or_empty(step.pattern) if step.pattern is not None else ""


def _between(start: Latent, end: Latent, share: float) -> Latent:
    return ((1 - share) * start + share * end).astype(np.float32)


def _drawn(here: Float32[np.ndarray, "n latent"], random: np.random.Generator) -> Latent:
    spread = np.linalg.cholesky(np.cov(here.T) + 1e-6 * np.eye(here.shape[1]))
    return (here.mean(0) + spread @ random.standard_normal(here.shape[1])).astype(np.float32)
