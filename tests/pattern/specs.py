"""Tiny specifications, written out by hand."""

import copy
import json

SQUARE = [[0, 0], [30, 0], [30, 40], [0, 40]]


def edges(*ends, **curvatures):
    """Edges between vertex numbers; `e2=...` gives edge 2 a curvature."""
    found = [{"endpoints": list(pair)} for pair in ends]
    for key, curvature in curvatures.items():
        found[int(key[1:])]["curvature"] = curvature
    return found


def panel(vertices=SQUARE, ends=((0, 1), (1, 2), (2, 3), (3, 0)), z=20, **curvatures):
    return {
        "translation": [0, 100, z],
        "rotation": [0, 0 if z > 0 else 180, 0],
        "vertices": copy.deepcopy(vertices),
        "edges": edges(*ends, **curvatures),
    }


def spec(panels=None, stitches=None, **properties):
    """A garment of two squares sewn at the sides, or whatever is given."""
    if panels is None:
        panels = {"front": panel(), "back": panel(z=-20)}
    if stitches is None:
        stitches = [stitch(("front", 1), ("back", 3)), stitch(("front", 3), ("back", 1))]
    given = {"curvature_coords": "relative", "units_in_meter": 100, **properties}
    return {"pattern": {"panels": panels, "stitches": stitches}, "properties": given}


def stitch(a, b, *flag):
    return [{"panel": a[0], "edge": a[1]}, {"panel": b[0], "edge": b[1]}, *flag]


def one_panel(**curvatures):
    return spec({"front": panel(**curvatures)}, [])


def written(path, data):
    path.write_text(json.dumps(data), encoding="utf-8")
    return path
