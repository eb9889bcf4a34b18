"""Cases of a scenario, and what they change."""

import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenario_files import DELETED, TABLES, H

from antenna_pin.scenario import LawSpec
from antenna_pin.scenario.merge import merge


def test_a_case_is_laid_over_the_file(folder):
    """It removes what its keys exclude, and may replace a table, or all of a kind."""
    scenario = folder.load(case="tight")
    assert (scenario.case, scenario.description) == ("tight", "less play")
    base = folder.load()
    assert scenario.clearance["hinge"] == base.clearance["hinge"].model_copy(
        update={"radial_clearance": 1e-5}
    )
    assert scenario.drives == base.drives
    hinge = folder.load(case="by-radius").clearance["hinge"]
    assert (hinge.radial_clearance, hinge.journal_radius) == (None, 0.0099)
    assert (hinge.axial_clearance, hinge.flange_distance) == (None, 0.0501)
    # Differences of lengths about 10 mm, to round-off.
    assert hinge.radial_play == pytest.approx(1e-4, abs=1e-17)
    assert hinge.axial_play == pytest.approx(5e-5, abs=1e-17)
    assert folder.load(case="elastic").clearance["hinge"].normal == LawSpec(law="hertz")
    changes = {"cases.elastic.clearance.hinge.normal": {"law": "hertz"}}
    message = folder.refusal(changes, case="elastic")
    assert message == (
        "clearance.hinge.normal.restitution is unknown; law hertz takes stiffness, exponent "
        "(case elastic sets law: add replace = true to drop the old keys)"
    )
    scenario = folder.load({"cases.quiet": {"drives": {"replace": True}}}, case="quiet")
    assert scenario.drives == {}
    changes = {"default_case": "tight"}
    assert folder.load(changes).case == "tight"
    assert folder.load(changes, case="elastic").case == "elastic"


def test_values_beside_the_case_are_told_by_their_place_in_the_case(folder):
    """Also what a file gets after it was loaded."""
    changes = {"cases.tight.clearance.hinge.radial_clearance": "10 us"}
    wanted = "cases.tight.clearance.hinge.radial_clearance must be a length [m], got '10 us' (time)"
    assert folder.refusal(changes, case="tight") == wanted
    assert folder.refusal(changes) == wanted  # though it is not the case to be run
    assert folder.refusal(changes, case="elastic") == wanted
    assert folder.load(case="elastic").case == "elastic"
    for _ in range(2):  # what is known of a sound file is not of another
        assert "tight" in folder.refusal({"cases.tight.clearance.hinge.colour": "red"}, case="elastic")
    assert folder.load(case="elastic").case == "elastic"


@pytest.mark.parametrize("case", [None, "tight"])
def test_a_case_that_is_not_run_needs_no_files(folder, case):
    changes = {"cases.other": {"drives": {"slow": {"file": "of_tomorrow.csv"}}}}
    assert folder.load(changes, case=case).case == case
    message = folder.refusal(changes, case="other")
    assert message.startswith("cases.other.drives.slow.file must be an existing file, got 'of_tomorrow.csv'")


def test_what_overrides_complete_is_no_fault_of_a_case(folder):
    """A file may leave open what every run gives."""
    changes = {H + "radial_clearance": DELETED, "cases.by-radius": DELETED, "cases.tight": DELETED}
    changes["cases.flat"] = {"clearance": {"hinge": {"axial_clearance": 0}}}
    wanted = "clearance.hinge must have exactly one of radial_clearance and journal_radius, got neither"
    assert folder.refusal(changes) == wanted
    overrides = ["clearance.hinge.radial_clearance=0.1 mm"]
    assert folder.load(changes, overrides=overrides).clearance["hinge"].radial_clearance == 1e-4


def test_a_table_of_numbers_in_a_case_is_checked(folder):
    """In a case that is not to be run, too."""
    changes = {"cases.other": {"drives": {"slow": {"time": [0, 0, 1], "torque": [1, 2, 3]}}}}
    wanted = "cases.other.drives.slow.time[1] must be above the one before, 0.0, got 0.0"
    assert folder.refusal(changes) == folder.refusal(changes, case="other") == wanted
    both = {"cases.other": {"drives": {"slow": {"time": [0, 1], "file": "torque.csv"}}}}
    wanted = "cases.other.drives.slow must have either file, or time and torque, got both"
    assert folder.refusal(both) == folder.refusal(both, case="other") == wanted


# Names of what a table holds, to build tables of the kinds that are merged.
DOCUMENTS = st.dictionaries(st.sampled_from("abc"), TABLES, max_size=3)


@given(base=DOCUMENTS)
def test_merging_nothing_changes_nothing(base):
    assert merge(base, {}) == base
    assert merge({}, base) == base
    assert merge(base, base) == base


@given(base=DOCUMENTS, over=DOCUMENTS, top=DOCUMENTS)
def test_merging_keeps_all_that_is_laid_over(base, over, top):
    before = copy.deepcopy((base, over))
    merged = merge(base, over)
    assert (base, over) == before
    assert merge(merged, over) == merged
    assert merged.keys() == base.keys() | over.keys()
    for key in base.keys() - over.keys():
        assert merged[key] == base[key]
    for key, value in over.items():
        if not isinstance(value, dict):
            assert merged[key] == value


def test_arrays_are_replaced_as_a_whole():
    assert merge({"a": {"b": [1, 2, 3], "c": 1}}, {"a": {"b": [4]}}) == {"a": {"b": [4], "c": 1}}
