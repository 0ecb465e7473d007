"""Whether what is sewn onto cloth in one pattern is sewn on at the same place in another."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from garmentimage.compare.matching import POSES, iou_by_pose
from garmentimage.geometry import centroid
from garmentimage.pattern import Pattern, SewnOnto

PLACE_TOL_CM = 0.5  # the middle of a pocket may lie so far from its place on the panel beneath
LENGTH_TOL_CM = 2.0  # so much more or less of its outline may be sewn on
ALIKE = 0.02  # poses whose IoU is less by no more than this fit as well


def onto_differences(
    original: Pattern, decoded: Pattern, panel_map: Mapping[str, str], *, any_pose: bool = False
) -> list[str]:
    """In words, what is sewn onto cloth otherwise; `panel_map` says which panel is which.

    With `any_pose`, panels may be mirrored and turned by quarters in their own coordinates.
    """
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
