"""The word of a topology: the same for garments sewn alike, another for others."""

from garmentimage.compare import stitch_graph
from garmentimage.compare.topology import topology_hash
from garmentimage.draft.sampling import sample


def words(kind: str, **fixed) -> set[str]:
    return {topology_hash(stitch_graph(each.pattern)) for each in sample(kind, 12, 5, fixed=fixed)}


def test_garments_of_one_topology_have_one_word_whatever_their_sizes():
    kinds = {
        "dress": words("one-panel-dress", sleeves="none", cutout="none"),
        "sleeved dress": words("one-panel-dress", sleeves="set-in", cutout="none"),
        "dress with a hole": words("one-panel-dress", sleeves="none", cutout="front"),
        "jumpsuit": words("one-panel-jumpsuit", sleeves="none"),
        "top and trousers": words("top-pants", sleeves="none"),
        "top and skirt": words("top-skirt", sleeves="none"),
        "shirt": words("shirt", panels_a_side=2, front_darts="none", back_darts="none",
                       sleeves="none", cuffs="none"),
        "shirt with darts": words("shirt", panels_a_side=2, front_darts="waist",
                                  back_darts="waist", sleeves="none", cuffs="none"),
    }  # fmt: skip
    assert all(len(found) == 1 for found in kinds.values()), kinds
    assert len(set.union(*kinds.values())) == len(kinds)
