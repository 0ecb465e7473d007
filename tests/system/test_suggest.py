from garmentimage.system.suggest import did_you_mean


def test_near_names_are_suggested():
    assert did_you_mean("skrit", ["skirt", "shirt", "dress"]) == "did you mean skirt or shirt"


def test_without_a_near_name_there_is_a_choice_or_another_remedy():
    assert did_you_mean("coat", ["skirt", "dress"]) == "choose skirt or dress"
    assert did_you_mean("coat", ["skirt"], otherwise="remove it") == "remove it"


def test_long_lists_are_cut_and_empty_ones_are_no_list():
    assert did_you_mean("x", [f"part-{k}" for k in range(30)]).endswith("part-11 or 18 more")
    assert did_you_mean("x", []) == "there are none to choose from"
