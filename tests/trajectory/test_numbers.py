"""Numbers of a result that cannot be: which one is named, and what the edge of each rule is."""

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.trajectory.check import problem_of
from antenna_pin.trajectory.columns import ColumnRule


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A run of a few episodes of contact, as it is read from its file."""
    run = simulate(load_scenario("impact_pair", case="contact"), duration=2e-3)
    return Trajectory.load(run.save(tmp_path_factory.mktemp("results") / "run.nc")).data


@pytest.mark.parametrize("number", [-1, 4, 1.0], ids=["below zero", "beyond the last", "not whole"])
def test_an_episode_of_no_contact_is_refused(data, number):
    assert problem_of(data) is None and data.sizes["contact"] == 4
    episodes = np.array([number, *data["episode_contact"].values[1:]])
    spoiled = data.assign(episode_contact=("episode", episodes))
    assert problem_of(spoiled) == "numbers in 'episode_contact' that are of no contact"


@pytest.mark.parametrize(
    ("rule", "good", "bad"),
    [
        (ColumnRule(), [-1e300, 0.0], [0.0, np.nan]),
        (ColumnRule(lacks=True), [np.nan, 1.0], [np.nan, np.inf]),
        (ColumnRule(infinite=True), [np.inf, -np.inf], [np.inf, np.nan]),
        (ColumnRule(least=0.0), [0.0, 1.0], [0.0, -5e-324]),
        (ColumnRule(most=1.0), [-1.0, 1.0], [1.0, 1.0 + 2.3e-16]),
        (ColumnRule(only=(0.0, 1.0)), [1.0, 0.0], [1.0, 0.5]),
        (ColumnRule(rising=True), [1.0, 1.0], [1.0, 1.0 - 1.2e-16]),
        (ColumnRule(unit=True), [[0.6, 0.8], [0.0, 1.0 + 0.9e-6]], [[0.6, 0.8], [0.0, 1.0 + 1.1e-6]]),
    ],
    ids=lambda one: one.words if isinstance(one, ColumnRule) else "",
)
def test_a_rule_holds_up_to_its_bound_and_no_further(rule, good, bad):
    assert rule.breach(np.array(good)) is None
    breach = rule.breach(np.array(bad))
    assert breach is not None and breach.row == 1
    assert rule.breach(np.array(bad)[:1]) is None
