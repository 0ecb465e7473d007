"""Random designs: a kind, a body and values for all its parameters, corners included."""

from hypothesis import strategies as st

from garmentimage.body.body_measurements import presets
from garmentimage.draft.kind import KINDS

BODIES = tuple(presets())
FLAT = {"cap_fullness": 1.0, "cuff_fullness": 1.0, "skirt_fullness": 1.0}
"""Nothing is gathered."""
EVEN = {"hem_slant": 0.0, "skirt_slant": 0.0, "pockets": "both"}
"""Left and right are alike."""


def values_at(parameters, share):
    """Every parameter at a share of its range."""
    return {
        name: p.options[round(share * (len(p.options) - 1))]
        if p.options
        else p.low + share * (p.high - p.low)
        for name, p in parameters.items()
    }


def _value(parameter):
    if parameter.options:
        return st.sampled_from(parameter.options)
    return st.one_of(
        st.sampled_from((parameter.low, parameter.high)),
        st.integers(0, 1000).map(
            lambda k: parameter.low + k / 1000 * (parameter.high - parameter.low)
        ),
    )


@st.composite
def designs(draw, kinds=tuple(KINDS), bodies=BODIES, **fixed):
    """(kind, body, parameters); `fixed` values hold for the kinds that have the parameter."""
    kind = draw(st.sampled_from(kinds))
    values = {name: draw(_value(p)) for name, p in KINDS[kind].parameters.items()}
    values |= {name: value for name, value in fixed.items() if name in values}
    return kind, draw(st.sampled_from(bodies)), values
