"""Tables of one of several kinds: made when one is met, found by name, refused in their place."""

import pickle
import re
import subprocess
import sys
from typing import get_args

import pytest

from antenna_pin.errors import ScenarioError
from antenna_pin.scenario import FAMILY_SPECS, REFERENCE_SPECS, Scenario, load_scenario
from antenna_pin.scenario._class_tables import CONTROLLER_SPECS, COUPLING_SPECS, EVENT_SPECS, FLEXIBLE_SPECS
from antenna_pin.scenario.closures import AnyCoupling
from antenna_pin.scenario.events import EventSpec
from antenna_pin.scenario.flexible import FlexibleSpec


@pytest.mark.parametrize(
    ("tables", "classes", "key"),
    [
        (COUPLING_SPECS, AnyCoupling, "kind"),
        (EVENT_SPECS, EventSpec, "kind"),
        (FLEXIBLE_SPECS, FlexibleSpec, "kind"),
    ],
    ids=["couplings", "events", "flexible"],
)
def test_the_kinds_are_those_of_the_classes(tables, classes, key):
    said = {kind: cls for cls in get_args(classes) for kind in get_args(cls.model_fields[key].annotation)}
    assert dict(tables) == said


@pytest.mark.parametrize("tables", [*FAMILY_SPECS.values(), REFERENCE_SPECS, CONTROLLER_SPECS])
def test_a_class_is_made_once_and_found_by_its_name(tables):
    for kind in tables:
        cls = tables[kind]
        assert tables[kind] is cls
        assert pickle.loads(pickle.dumps(cls)) is cls
        assert cls.model_fields["kind"].annotation.__args__ == (kind,)
    assert "no such kind" not in tables
    with pytest.raises(KeyError):
        tables["no such kind"]


def test_a_scenario_is_unpickled_where_no_table_has_been_made():
    code = (
        "import pickle, sys\n"
        "scenario = pickle.loads(sys.stdin.buffer.read())\n"
        "print(type(scenario.drives['elevation']).__name__, scenario.drives['elevation'].build())\n"
    )
    scenario = load_scenario("bai2020")
    done = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(scenario), capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    said = f"{type(scenario.drives['elevation']).__name__} {scenario.drives['elevation'].build()}\n"
    assert done.stdout.decode() == said


def test_what_is_no_table_is_refused_in_its_place():
    data = load_scenario("bai2020").model_dump()
    data["drives"]["elevation"] = 3
    with pytest.raises(
        ScenarioError, match=f"^{re.escape('Scenario: drives.elevation must be a table, got 3')}$"
    ):
        Scenario.model_validate(data)
