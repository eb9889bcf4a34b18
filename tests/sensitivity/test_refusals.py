"""What has no derivative, and what is asked for wrongly, in one line each."""

import numpy as np
import pytest

from antenna_pin import AntennaPinError, load_scenario
from antenna_pin.studies.sensitivity import GrazeError, SensitivityError, sensitivities

PLAIN = {"integrator.engine": "compiled", "mechanism.base": "fixed", "clearance.bore.geometry": "closed-form"}
SPEED = "initial.joints.bore.journal_velocity[0]"


@pytest.fixture(scope="module")
def impact():
    """A disc that meets the wall of its bore after 1 ms."""
    return load_scenario("impact_pair", case="planar", overrides=PLAIN)


@pytest.mark.parametrize(
    ("keys", "more", "said"),
    [
        ([], {}, "keys must be one key of the scenario or more"),
        ([SPEED, SPEED], {}, f"named once each, got {SPEED} twice"),
        (["integrator.rtol"], {}, "must be of the mechanism, its loads or its start"),
        (["clearance.bore.strips"], {}, "must be a number that may differ by little, got 16"),
        (["clearance.bore.radial_clearence"], {}, "did you mean clearance.bore.radial_clearance?"),
        (["clearance.bore.maximum_depth"], {}, "set it first, if it is left out"),
        (["initial.joints.bore.journal_velocity[1]"], {}, "given with its scale"),
        (["initial.joints.bore.journal_velocity[7]"], {}, "one of 3 numbers of an array"),
        ({SPEED: "1 kg"}, {}, "must be a speed"),
        ([SPEED], {"times": [2e-3, 1e-3]}, "times must be finite and ascending"),
        ([SPEED], {"times": [-1e-3]}, "times must be from 0 s on"),
        ([SPEED], {"times": [2e-3], "duration": 1e-3}, "within the run, which ends at 0.001 s"),
    ],
)
def test_what_is_asked_for_wrongly(impact, keys, more, said):
    """Place, rule, what was given, before any run is made."""
    with pytest.raises(AntennaPinError, match=said.replace("[", r"\[").replace("?", r"\?")):
        sensitivities(impact, keys, **more)


def test_a_number_at_the_end_of_its_range_has_no_neighbours(impact):
    """A restitution of 1 has none above it."""
    elastic = impact.with_overrides({"clearance.bore.normal.restitution": 1.0})
    with pytest.raises(AntennaPinError, match="restitution must have room on both sides"):
        sensitivities(elastic, ["clearance.bore.normal.restitution"], [2e-3])


@pytest.mark.parametrize("method", ["runs", "quick-runs", "equation"])
def test_a_graze_is_refused_with_its_instant(impact, method):
    """The run ends as the disc arrives: of neighbours that are later none touches. 0.1 mm at 0.1 m/s."""
    with pytest.raises(GrazeError, match="other contacts begin") as caught:
        sensitivities(impact, [SPEED], duration=1e-3 + 1e-13, method=method)
    assert caught.value.time == pytest.approx(1e-3, rel=1e-6)


# Differences of second order of steps of 1e-4 leave 1e-8 / 8 of it; the equation where instants are located.
@pytest.mark.parametrize(("method", "good"), [("quick-runs", 1e-7), ("equation", 1e-10)])
def test_rims_that_are_met_at_once_are_no_graze(method, good):
    """A journal falls onto both rims of its bore, and leaves both: which is noted first changes by chance.

    It falls for sqrt(2 c / g'), half of which is the derivative over the logarithm of the clearance.
    """
    plain = {"clearance.hinge.geometry": "closed-form", "integrator.engine": "compiled"}
    pendulum = load_scenario("pendulum", case="contact", overrides=plain)
    key = "clearance.hinge.radial_clearance"
    found = sensitivities(pendulum, [key], [0.02], method=method)
    onsets, slopes = found.run.data["onset_time"].values, found.relative("onset_time")[:, 0]
    assert len(onsets) == 6 and np.ptp(onsets.reshape(3, 2), axis=1).max() < 1e-11
    assert slopes[:2] == pytest.approx(onsets[:2] / 2.0, rel=good)
    assert np.ptp(slopes.reshape(3, 2), axis=1).max() < 1e-7 * slopes.max()


def test_what_is_built_of_a_neighbour_is_told_with_its_value():
    """Materials give a stiffness for an exponent of 1.5 alone."""
    pair = load_scenario("impact_pair", overrides={"clearance.bore.normal.exponent": 1.5})
    key = "clearance.bore.normal.exponent"
    with pytest.raises(
        SensitivityError, match=rf"with {key} = 1\.5\d+, which is next to its value: .*stiffness"
    ):
        sensitivities(pair, [key], [1e-4], method="quick-runs")
