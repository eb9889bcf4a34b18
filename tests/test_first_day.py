"""What a first script writes: names and paths for scenarios, text for times, quantities by name."""

import importlib
import pkgutil
import tomllib
from pathlib import Path

import numpy as np
import pytest

import antenna_pin
from antenna_pin import load_scenario, load_study, open_run, simulate
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.events import Event, Time
from antenna_pin.run.session import start
from antenna_pin.scenario import models_path
from antenna_pin.studies.linear import modes
from antenna_pin.studies.sweep.responses import ResponseSpec


@pytest.fixture(scope="module")
def run():
    return simulate("impact_pair", "2 ms", events=[Event(name="half", when=Time("1 ms"))])


def test_the_version_is_that_of_the_project():
    text = (Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    assert antenna_pin.__version__ == tomllib.loads(text)["project"]["version"]


def test_a_name_or_a_path_is_a_scenario_in_its_default_case():
    whole = simulate(load_scenario("impact_pair"), duration=2e-3)
    other = simulate(models_path() / "impact_pair" / "scenario.toml", "2 ms")
    for named in (other, simulate("impact_pair", 2e-3)):
        assert np.array_equal(named.data["q"], whole.data["q"])
    assert modes("shaker").frequency.size == modes(load_scenario("shaker")).frequency.size
    assert start("impact_pair").time == 0.0
    with pytest.raises(UnknownNameError, match="did you mean bai2020"):
        simulate("bai202", "1 s")


def test_quantities_times_and_events_are_found_by_name(run, tmp_path):
    again = open_run(run.save(tmp_path / "run.nc"))
    contact = str(run.data["contact"].values[0])
    for name, variable, at in (
        ("bore.angle", "motion_angle", {"joint": "bore"}),
        (f"{contact}.gap", "gap", {"contact": contact}),
        ("kinetic_energy", "kinetic_energy", {}),
    ):
        stored = again.data[variable].sel(at)
        assert np.array_equal(again[name], stored) and again[name].attrs["units"] == stored.attrs["units"]
        assert np.array_equal(again[name]["time"], again.time)
    assert [(one.name, one.time, one.energy) for one in again.events] == [("half", 1e-3, 0.0)]
    with pytest.raises(UnknownNameError, match=r"did you mean bore\.angle\?"):
        run["bore.angel"]


def test_what_completion_finds_is_the_scenarios_own_and_messages_are_one_line():
    scenario = load_scenario("impact_pair")
    for table in (scenario, scenario.mechanism, load_study("bai2020/clearances")):
        assert not [name for name in dir(table) if name.startswith(("model_", "parse_", "construct"))]
        assert {"duration", "scenario", "urdf"} & set(dir(table))
    with pytest.raises(AntennaPinError) as refusal:
        scenario.duration = 3.0
    assert "with_overrides" in str(refusal.value) and "pydantic" not in str(refusal.value)


def test_an_underscore_is_a_hyphen_in_the_name_of_a_component():
    assert ResponseSpec(measure="pointing", component="half_cone").component == "half-cone"


@pytest.mark.parametrize("name", antenna_pin._FORMER)
def test_packages_are_found_by_their_former_places(name):
    """The same modules, files within them too: a class would else be two, and no instance of the other."""
    own = importlib.import_module(f"antenna_pin.{antenna_pin._FORMER[name]}.{name}")
    assert importlib.import_module(f"antenna_pin.{name}") is own is getattr(antenna_pin, name)
    assert own.__spec__.name == own.__name__
    for found in pkgutil.iter_modules(own.__path__):
        if found.name != "__main__":
            former = importlib.import_module(f"antenna_pin.{name}.{found.name}")
            assert former is importlib.import_module(f"{own.__name__}.{found.name}")


def test_names_that_moved_are_found_with_their_new_place():
    with pytest.warns(DeprecationWarning, match=r"\.start is antenna_pin\.run\.session\.start now"):
        moved = antenna_pin.start
    assert moved is antenna_pin.run.session.start and "start" not in antenna_pin.__all__
    with pytest.raises(AttributeError, match="has no attribute 'begin'"):
        antenna_pin.begin  # noqa: B018


def test_the_top_level_is_short():
    assert len(antenna_pin.__all__) <= 27
