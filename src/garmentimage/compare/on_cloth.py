"""Whether two patterns have the same on their cloth: what is sewn on, and pressed pleats."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from garmentimage.compare.matching import POSES, iou_by_pose
from garmentimage.geometry import centroid
from garmentimage.pattern import Pattern, Pleat, SewnOnto

PLACE_TOL_CM = 0.5  # the middle of a pocket may lie so far from its place on the panel beneath
LENGTH_TOL_CM = 2.0  # so much more or less of its outline may be sewn on
PRESSED_TOL_CM = 1.0  # a pleat may be pressed for so much more or less
PLEAT_TOL_CM = 2.0  # the middle of a pleat may lie so far from its place
ALIKE = 0.02  # poses whose IoU is less by no more than this fit as well


def differences_on_cloth(
    original: Pattern, decoded: Pattern, panel_map: Mapping[str, str], *, any_pose: bool = False
) -> list[str]:
    """In words, what is sewn onto cloth or pressed otherwise.

    Args:
        original: the pattern that it should be.
        decoded: the pattern that it is.
        panel_map: for panels of the one those of the other.
        any_pose: panels may be mirrored and turned by quarters in their own coordinates.
    """
    sewn_on = _onto_differences(original, decoded, panel_map, any_pose=any_pose)
    return sewn_on + _pleat_differences(original, decoded, panel_map, any_pose=any_pose)


def _onto_differences(
    original: Pattern, decoded: Pattern, panel_map: Mapping[str, str], *, any_pose: bool
) -> list[str]:
    found = {sewn.panel: sewn for sewn in decoded.onto}
    reasons = []
    for sewn in original.onto:
        other = found.pop(panel_map.get(sewn.panel, ""), None)
        if other is None or other.on != panel_map.get(sewn.on):
            reasons.append(f"panel {sewn.panel!r} is not sewn onto panel {sewn.on!r}")
            continue
        lengths = [
            sum(pattern.curve(side).length for side in each.sides)
            for pattern, each in ((original, sewn), (decoded, other))
        ]
        if abs(lengths[0] - lengths[1]) > LENGTH_TOL_CM:
            reasons.append(
                f"{lengths[1]:.1f} cm of panel {sewn.panel!r} are sewn onto panel {sewn.on!r} "
                f"instead of {lengths[0]:.1f}"
            )
        ours, theirs = _place(original, sewn), _place(decoded, other)
        apart = min(
            float(np.hypot(*(ours - pose @ theirs)))
            for pose in _poses(original, decoded, sewn.on, other.on, any_pose=any_pose)
        )
        if apart > PLACE_TOL_CM:
            reasons.append(
                f"panel {sewn.panel!r} is sewn onto panel {sewn.on!r} {apart:.1f} cm from its place"
            )
    reasons += [f"panel {panel!r} is sewn onto another, and was not" for panel in sorted(found)]
    return reasons


def _place(pattern: Pattern, sewn: SewnOnto) -> Float[np.ndarray, " 2"]:
    """Where the middle of a pocket lies, seen from the middle of the panel beneath [cm]."""
    own, base = (pattern.by_name[name].outline.fine_polygon for name in (sewn.panel, sewn.on))
    return np.asarray(sewn.carried(centroid(own)[None])[0] - centroid(base))


def _poses(
    original: Pattern, decoded: Pattern, ours: str, theirs: str, *, any_pose: bool
) -> list[Float[np.ndarray, "2 2"]]:
    """The poses in which a panel fits its counterpart."""
    if not any_pose:
        return [POSES[0]]
    iou = iou_by_pose([original.by_name[ours]], [decoded.by_name[theirs]], range(len(POSES)))
    return [POSES[k] for k in np.flatnonzero(iou[:, 0, 0] >= iou.max() - ALIKE)]


def _pleat_differences(
    original: Pattern, decoded: Pattern, panel_map: Mapping[str, str], *, any_pose: bool
) -> list[str]:
    reasons = []
    for panel, other in panel_map.items():
        ours, theirs = (
            [pleat for pleat in pattern.pleats if pleat.panel == name]
            for pattern, name in ((original, panel), (decoded, other))
        )
        if len(ours) != len(theirs):
            reasons.append(
                f"panel {panel!r} comes back with {len(theirs)} pressed pleats instead of "
                f"{len(ours)}"
            )
        elif ours:
            poses = _poses(original, decoded, panel, other, any_pose=any_pose)
            in_pose = [_mispressed(original, decoded, ours, theirs, pose) for pose in poses]
            fewest: list[str] = min(in_pose, key=len)
            reasons += fewest
    return reasons


def _mispressed(
    original: Pattern,
    decoded: Pattern,
    ours: list[Pleat],
    theirs: list[Pleat],
    pose: Float[np.ndarray, "2 2"],
) -> list[str]:
    """In words, which pleats of a panel are not those of its counterpart, in one pose of it."""
    places = np.array([_middle(decoded, pleat) @ pose.T for pleat in theirs])
    reasons = []
    for pleat in ours:
        apart = np.hypot(*(places - _middle(original, pleat)).T)
        other = theirs[int(apart.argmin())]
        if apart.min() > PLEAT_TOL_CM:
            reasons.append(
                f"a pleat of panel {pleat.panel!r} is {apart.min():.1f} cm off its place"
            )
        elif other.fold != pleat.fold or abs(other.pressed - pleat.pressed) > PRESSED_TOL_CM:
            reasons.append(
                f"a pleat of panel {pleat.panel!r} comes back {other.fold}, pressed for "
                f"{other.pressed:.1f} cm, instead of {pleat.fold}, {pleat.pressed:.1f} cm"
            )
    return reasons


def _middle(pattern: Pattern, pleat: Pleat) -> Float[np.ndarray, " 2"]:
    """The fold beneath of a pleat, seen from the middle of its panel [cm]."""
    point = np.array(pattern.curve(pleat.sides[0]).end)
    return np.asarray(point - centroid(pattern.by_name[pleat.panel].outline.fine_polygon))
