"""From a pattern to the values of a specification.json."""

from typing import Any

from garmentimage.pattern.checks import check_structure
from garmentimage.pattern.files.spec_reader import (
    CM_PER_METRE,
    OURS,
    SAME_DIRECTION_FLAG,
    SCHEMA,
    ordered_names,
)
from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Edge,
    Loop,
    Panel,
    Pattern,
    Pleat,
    Quadratic,
    SewnOnto,
    Stitch,
)

WRITTEN_PROPERTIES = {
    "curvature_coords": "relative",
    "normalize_panel_translation": False,
    "units_in_meter": CM_PER_METRE,
}


def pattern_to_spec(pattern: Pattern) -> dict[str, Any]:
    """The pattern as specification.json holds it: GarmentCode's syntax, cm, relative curvature.

    Raises:
        PatternError: the pattern has a fault that a file cannot hold.
    """
    check_structure(pattern)
    extra = pattern.extra
    body = {
        **extra.get("pattern", {}),
        "panels": {p.name: _panel_spec(p) for p in pattern.panels},
        "stitches": [_stitch_spec(s) for s in pattern.stitches if not _touches_hole(pattern, s)],
    }
    if "panel_order" in body:
        body["panel_order"] = ordered_names(body["panel_order"], body["panels"])
    data = {
        "pattern": body,
        **extra.get("top", {}),
        "properties": {**extra.get("properties", {}), **WRITTEN_PROPERTIES},
    }
    ours = _ours_spec(pattern)
    return {**data, OURS: ours} if ours else data


def _panel_spec(panel: Panel) -> dict[str, Any]:
    label = {} if panel.label is None else {"label": panel.label}
    return {
        **panel.extra,
        "translation": list(panel.translation),
        "rotation": list(panel.rotation),
        **_loop_spec(panel.outline),
        **label,
    }


def _loop_spec(loop: Loop) -> dict[str, Any]:
    return {
        "vertices": [list(v) for v in loop.vertices],
        "edges": [_edge_spec(e) for e in loop.edges],
    }


def _edge_spec(edge: Edge) -> dict[str, Any]:
    data: dict[str, Any] = {**edge.extra, "endpoints": [edge.start, edge.end]}
    match edge.curvature:
        case Quadratic(control):
            data["curvature"] = {"type": "quadratic", "params": [list(control)]}
        case Cubic(control, control2):
            data["curvature"] = {"type": "cubic", "params": [list(control), list(control2)]}
        case Circle(radius, large, right):
            data["curvature"] = {"type": "circle", "params": [radius, int(large), int(right)]}
    if edge.label is not None:
        data["label"] = edge.label
    return data


def _stitch_spec(stitch: Stitch) -> list[Any]:
    sides: list[Any] = [
        {**stitch.extra.get(key, {}), "panel": side.panel, "edge": side.edge}
        for key, side in (("a", stitch.a), ("b", stitch.b))
    ]
    flag = SAME_DIRECTION_FLAG if stitch.same_direction else stitch.flag
    return sides if flag is None else [*sides, flag]


def _touches_hole(pattern: Pattern, stitch: Stitch) -> bool:
    panels = pattern.by_name
    return any(side.edge >= len(panels[side.panel].outline.edges) for side in stitch.sides)


def _ours_spec(pattern: Pattern) -> dict[str, Any]:
    """The field "garmentimage", empty where the plain format says it all."""
    unknown = dict(pattern.extra.get("ours", {}))
    unknown_panels = unknown.pop("panels", {})
    panels = {}
    for panel in pattern.panels:
        fields = {**unknown_panels.get(panel.name, {}), **_panel_ours(panel)}
        if fields:
            panels[panel.name] = fields
    stitches = [
        {"position": k, "stitch": _stitch_spec(s)}
        for k, s in enumerate(pattern.stitches)
        if _touches_hole(pattern, s)
    ]
    ours = {
        **unknown,
        **({"panels": panels} if panels else {}),
        **({"stitches": stitches} if stitches else {}),
    }
    newer = {
        "onto": [_onto_spec(sewn) for sewn in pattern.onto],
        "pleats": [_pleat_spec(pleat) for pleat in pattern.pleats],
    }
    newer = {name: fields for name, fields in newer.items() if fields}
    if newer:
        return {"schema": SCHEMA, **ours, **newer}
    return {"schema": 1, **ours} if ours else {}


def _onto_spec(sewn: SewnOnto) -> dict[str, Any]:
    return {
        "panel": sewn.panel,
        "edges": list(sewn.edges),
        "on": sewn.on,
        "matrix": [list(row) for row in sewn.matrix],
        "offset": list(sewn.offset),
    }


def _pleat_spec(pleat: Pleat) -> dict[str, Any]:
    return {
        "panel": pleat.panel,
        "edges": list(pleat.edges),
        "fold": pleat.fold,
        "pressed": pleat.pressed,
    }


def _panel_ours(panel: Panel) -> dict[str, Any]:
    data: dict[str, Any] = {}
    if panel.holes:
        data["holes"] = [_loop_spec(hole) for hole in panel.holes]
    if panel.grain is not None:
        data["grain"] = list(panel.grain)
    if panel.notches:
        data["notches"] = [{"edge": n.edge, "at": n.at} for n in panel.notches]
    if panel.cloth_layer:
        data["cloth_layer"] = panel.cloth_layer
    return data
