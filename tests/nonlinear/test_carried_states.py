"""A state as the start of another system: what is kept, and what the other system changes."""

import numpy as np
import pytest

from antenna_pin import build_system, load_scenario, simulate
from antenna_pin.base.records import CONTACT
from antenna_pin.dynamics import Workspace
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import Event, Force, Stop
from antenna_pin.studies.nonlinear import carried

PIN = "clearance.pin.radial_clearance"


@pytest.fixture(scope="module")
def crank():
    fast = {"integrator.engine": "compiled", "clearance.pin.geometry": "closed-form"}
    return load_scenario("slider_crank", overrides=fast)


@pytest.fixture(scope="module")
def pressed(crank):
    """A state in the midst of a contact."""
    contact = build_system(crank).contact_names[0]
    stop = Event(name="pressed", when=Force(contact, 10.0), action=Stop())
    state = simulate(crank, duration=3e-3, events=[stop]).end
    assert state.memory[0, 0] == 1.0
    return state


def gaps(system, state):
    table = np.zeros(system.rows, CONTACT)
    Workspace(system).locate(state.y, table)
    return table["gap"]


def test_the_same_system_goes_on_with_what_contacts_remember(crank, pressed):
    """Nothing but step sizes begins anew; what the loop is held by moves by round-off."""
    there = carried(pressed, build_system(crank))
    assert np.array_equal(there.memory, pressed.memory)
    assert there.contacts == pressed.contacts
    assert np.abs(there.y - pressed.y).max() < 1e-9 * np.abs(pressed.y).max()
    one = simulate(crank, start=pressed, duration=2e-3)
    other = simulate(crank, start=there, duration=2e-3)
    assert np.abs(one.data["q"][-1].values - other.data["q"][-1].values).max() < 1e-6


@pytest.mark.parametrize("clearance", [0.4e-3, 0.6e-3])
def test_a_contact_touches_where_its_gap_is_closed_there(crank, pressed, clearance):
    """In a wider play the contact is open; in a narrower one it touches still, and remembers its speed."""
    system = build_system(crank.with_overrides({PIN: clearance}))
    there = carried(pressed, system)
    assert np.array_equal(there.memory[:, 0] == 1.0, gaps(system, there) <= 0.0)
    assert len(there.contacts) == int(there.memory[:, 0].sum()) == (clearance < 0.5e-3)
    if there.contacts:
        assert np.array_equal(there.memory, pressed.memory)


def test_a_new_rate_keeps_the_place_of_the_crank(crank, pressed):
    """Time is stretched with the period: the crank is where it was, and turns at its new rate."""
    system = build_system(crank.with_overrides({"drives.crank.rate": "2500 rpm"}))
    there = carried(pressed, system, scale=2.0)
    assert there.time == 2.0 * pressed.time
    assert there.reached - there.time == pytest.approx(pressed.reached - pressed.time, abs=1e-15)
    assert np.abs(there.q - pressed.q).max() < 1e-9
    rate = system.drives["crank"].at(there.time)[1]
    assert rate == pytest.approx(2500 * 2 * np.pi / 60)
    turning = simulate(system, start=there, duration=1e-3).data["v"].sel(coordinate="crank")
    assert np.abs(turning - rate).max() < 1e-6 * rate


def test_a_state_of_another_size(pressed):
    with pytest.raises(AntennaPinError, match="start.q"):
        carried(pressed, build_system(load_scenario("pendulum", case="ideal")))
