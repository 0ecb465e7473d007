"""Sampling: garments of a kind or a template with parameters drawn at random, from a seed.

Sample k of a seed depends on the seed, the source and k alone: the same on any number of workers,
and whether ten samples are drawn or a million. A draw that cannot be worn is rejected with its
reason and drawn again.
"""

import math
import zlib
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from types import MappingProxyType
from typing import Any

import numpy as np

from garmentimage.body import BodyMeasurements, measurements, presets
from garmentimage.draft.kind import DEFAULT_BODY, Kind, find_kind
from garmentimage.draft.parameters import Parameter, Value, checked_values
from garmentimage.draft.templates import Template, as_json
from garmentimage.errors import DraftError, PatternError, quoted
from garmentimage.pattern import Pattern

END_SHARE = 0.03
"""Share of draws that a number's lowest value has, and its highest: corners of the ranges occur."""
MAX_DRAWS = 100
"""Attempts at a sample before an error: then the source hardly gives a garment."""
ANY_BODY = "any"
"""Draws the body among the shipped ones, too."""
SEED_LIMIT = 2**63
CHUNK = 32
"""Samples that a worker draws at a time."""

Source = Kind | Template


@dataclass(frozen=True)
class Sample:
    """One garment drawn at random, and how it can be made again."""

    source: str
    """Name of the kind or the template."""
    seed: int
    index: int
    body: str | None
    """Name of a shipped body; None for a body of one's own, and for a template."""
    parameters: Mapping[str, Any]
    pattern: Pattern
    rejected: tuple[str, ...]
    """Why the draws before it were rejected."""

    def record(self) -> dict[str, Any]:
        """What is written down of it, beside the pattern."""
        return {
            "source": self.source,
            "seed": self.seed,
            "index": self.index,
            "body": self.body,
            "parameters": {name: as_json(value) for name, value in self.parameters.items()},
            "rejected": list(self.rejected),
        }


def sample(
    source: str | Source,
    count: int,
    seed: int = 0,
    *,
    body: str | BodyMeasurements = DEFAULT_BODY,
    fixed: Mapping[str, Value] = MappingProxyType({}),
    workers: int = 1,
    first: int = 0,
) -> Iterator[Sample]:
    """Garments of a kind or of a template with parameters drawn at random, in order.

    Args:
        source: a name from `kinds()`, a Kind or a Template.
        count: how many.
        seed: the same seed always gives the same garments.
        body: measurements, the name of a shipped body, or "any" to draw among these, which is
            another draw in a version with another body; a template has its own.
        fixed: parameters of a kind that are not drawn, and their values; the others are drawn as
            without.
        workers: processes; the garments do not depend on it.
        first: index of the first garment, to continue where another call ended.

    Raises:
        DraftError: an unknown name, an invalid number, or a source that hardly gives a
            garment.
    """
    found = find_kind(source) if isinstance(source, str) else source
    if fixed and not isinstance(found, Kind):
        raise DraftError("the parameters of a template cannot be fixed; fix those of a kind")
    if isinstance(found, Kind):
        values = checked_values(found.parameters, fixed, f"kind {found.name}")
        fixed = {name: values[name] for name in fixed}
    for name, number in {"count": count, "first": first, "seed": seed}.items():
        if not 0 <= number < SEED_LIMIT:
            raise DraftError(f"{name} is {number}; give a whole number from 0")
    if isinstance(body, BodyMeasurements):
        body.check()
    elif body != ANY_BODY:
        measurements(body)
    return _samples(found, seed, body, dict(fixed), range(first, first + count), workers)


def _samples(
    source: Source,
    seed: int,
    body: str | BodyMeasurements,
    fixed: Mapping[str, Value],
    indices: range,
    workers: int,
) -> Iterator[Sample]:
    if workers <= 1 or len(indices) <= CHUNK:
        yield from map(partial(_one, source, seed, body, fixed), indices)
        return
    # The mappings of a kind cannot be pickled: workers look it up by its name.
    sent = source.name if isinstance(source, Kind) else source
    one = partial(_one, sent, seed, body, fixed)
    chunks = iter(indices[k : k + CHUNK] for k in range(0, len(indices), CHUNK))
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        waiting: deque[Future[list[Sample]]] = deque()
        for chunk in chunks:
            waiting.append(pool.submit(_chunk, one, chunk))
            if len(waiting) > 2 * workers:
                yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()


def _chunk(one: Callable[[int], Sample], indices: range) -> list[Sample]:
    return [one(index) for index in indices]


def _one(
    source: str | Source,
    seed: int,
    body: str | BodyMeasurements,
    fixed: Mapping[str, Value],
    index: int,
) -> Sample:
    source = find_kind(source) if isinstance(source, str) else source
    name = source.name if isinstance(source, Kind) else source.pattern.name
    key = zlib.crc32(name.encode())
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, key, index])))
    rejected: list[str] = []
    while len(rejected) < MAX_DRAWS:
        try:
            who, values, pattern = _drawn(source, body, fixed, random)
        except (DraftError, PatternError) as error:
            rejected.append(str(error))
            continue
        made = Sample(name, seed, index, who, values, pattern, tuple(rejected))
        ours = {**pattern.extra.get("ours", {}), "draft": made.record()}
        return replace(made, pattern=replace(pattern, extra={**pattern.extra, "ours": ours}))
    raise DraftError(
        f"{quoted(name)}, seed {seed}, garment {index}: rejected {MAX_DRAWS} times, the last time "
        f"because {rejected[-1]}"
    )


def _drawn(
    source: Source,
    body: str | BodyMeasurements,
    fixed: Mapping[str, Value],
    random: np.random.Generator,
) -> tuple[str | None, Mapping[str, Any], Pattern]:
    """The body's name, the values of the parameters, and the garment."""
    if isinstance(source, Template):
        values = source.draw(random)
        return None, values, source.with_values(values)
    who = None if isinstance(body, BodyMeasurements) else body
    if who == ANY_BODY:
        names = tuple(presets())
        who = names[int(random.random() * len(names))]
    drawn = {name: drawn_value(p, random) for name, p in source.parameters.items()}
    drawn |= dict(fixed)
    wearer = body if isinstance(body, BodyMeasurements) else measurements(who or DEFAULT_BODY)
    return who, drawn, source.draft(wearer, drawn)


def drawn_value(parameter: Parameter, random: np.random.Generator) -> Value:
    """A value of a parameter: each option as likely, numbers even over the range with its ends."""
    share = random.random()
    if parameter.options:
        return parameter.options[int(share * len(parameter.options))]
    inner = (share - END_SHARE) / (1 - 2 * END_SHARE)
    return parameter.low + min(max(inner, 0.0), 1.0) * (parameter.high - parameter.low)


def at_level(kind: Kind, level: float) -> dict[str, Value]:
    """All numbers of a kind at one share of their ranges, options likewise along their list."""
    if not 0.0 <= level <= 1.0:
        raise DraftError(f"level is {level:g}; give a share from 0 to 1")
    return {
        name: p.options[min(math.floor(level * len(p.options)), len(p.options) - 1)]
        if p.options
        else p.low + level * (p.high - p.low)
        for name, p in kind.parameters.items()
    }


def drafted(kind: Kind, body: BodyMeasurements, level: float) -> Pattern:
    """A garment with all parameters at one level of their ranges."""
    return kind.draft(body, at_level(kind, level))
