"""The ledger as an alarm: what a tolerance explains, where a ledger opens, and what becomes of such a run."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import pytest

from antenna_pin import Outcome, RunSettings, System, Trajectory, Urdf, build_mechanism, simulate
from antenna_pin.analysis import answer
from antenna_pin.elements import CallableElement, JointSpring, PrescribedMotion
from antenna_pin.errors import InvalidParameterError, LedgerOpenWarning
from antenna_pin.run.session import start
from antenna_pin.run.simulation import Event, Set, Time, checkpoint
from antenna_pin.run.simulation.ledger import FIXED_STEP, GROWTH, MOST

INERTIA, STIFFNESS = 0.6, 600.0
ARM = f"""
<robot name="arm">
  <link name="hull"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="{INERTIA - 0.5}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def arm(base: str = "fixed", **parts: Any) -> System:
    return System(build_mechanism(Urdf.from_text(ARM, "arm.urdf"), base), **parts)


def swing(amplitude: float, duration: float = 1.0, stiffness: float = STIFFNESS, **how: Any) -> Trajectory:
    """Return the run of an arm on a spring, let go from an angle."""
    system = arm(springs={"hinge": JointSpring(joint="hinge", stiffness=stiffness)})
    settings = RunSettings(**{"output_rate": 100.0, **how})
    return simulate(
        system, duration=duration, angles={"hinge": amplitude}, settings=settings, q=at(amplitude)
    )


def at(angle: float) -> list[float]:
    return [math.cos(angle), math.sin(angle)]


def lying(begin: float, energy: float) -> System:
    """An arm with a function in Python that does nothing, and from an instant on claims to store energy."""

    def act(t: float, p: Any, links: Any, joints: Any, states: Any, whole: Any) -> None:
        whole.energy = energy * (t >= begin)

    line = CallableElement(act=act, links=(("arm", (0.0, 0.0, 0.0)),), passive=True)
    return arm(elements={"forces": {"line": line}})


def conserved(run: Trajectory) -> dict[str, Any]:
    found: dict[str, Any] = run.summary()["conservation"]
    return found


def plain(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


def opened(system: System, **how: Any) -> Trajectory:
    with pytest.warns(LedgerOpenWarning):
        return simulate(system, **{"duration": 1.0, "v": [1.0], **how})


# --- no false alarm ---


@pytest.mark.parametrize("method", GROWTH)
@pytest.mark.parametrize("rtol", [1e-8, 1e-5])
@pytest.mark.parametrize("amplitude", [1.0, 1e-3, 1e-6])
def test_the_drift_of_an_oscillator_is_what_its_tolerance_explains(method, rtol, amplitude):
    """Five periods a second, and nothing lost: all that the energy changes by is the steps' error."""
    run = swing(amplitude, method=method, rtol=rtol)
    assert run.outcome is Outcome.COMPLETED, run.message
    assert 0.0 < conserved(run)["energy_error"] < conserved(run)["energy_tolerance"]


def test_an_error_of_a_tenth_is_explained_by_no_tolerance():
    """The method of order 3 loses most of the energy in 20 s at a tolerance of 1e-3: it is said so."""
    with pytest.warns(LedgerOpenWarning, match="tighten integrator.rtol"):
        run = swing(1.0, 20.0, method="bogacki-shampine-32", rtol=1e-3)
    kept = conserved(run)
    assert kept["energy_error_relative"] > 0.5
    # And what moves by its scales, which at this tolerance is not controlled: 1e-6 of 300 J, 126 times.
    assert kept["energy_tolerance"] / kept["energy_scale"] == pytest.approx(MOST, rel=0.05)


@pytest.mark.parametrize("method", ["dormand-prince-853", "dormand-prince-54", "radau5"])
@pytest.mark.parametrize(("stiffness", "amplitude"), [(1e6, 1e-15), (1e6, 1e-12), (1e6, 1e-9), (1e9, 1e-12)])
def test_what_moves_within_the_tolerance_is_not_controlled_and_no_alarm(method, stiffness, amplitude):
    """So stiff that steps hold it at some 1e-8 rad only: energies of 1e-22 to 1e-9 J, errors as large."""
    run = swing(amplitude, 0.3, stiffness=stiffness, method=method)
    assert run.outcome is Outcome.COMPLETED, run.message


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_at_rest_nothing_is_divided_by_round_off(base):
    """A spring is bent and held: it stores 75 J, and what moves is round-off."""
    spring = JointSpring(joint="hinge", stiffness=STIFFNESS, rest_angle=0.5)
    drive = PrescribedMotion(joint="hinge", position=0.0)
    run = simulate(arm(base, springs={"hinge": spring}, drives={"hinge": drive}), duration=0.5)
    kept = conserved(run)
    assert run.outcome is Outcome.COMPLETED, run.message
    assert (kept["energy_scale"], kept["energy_scale_of"]) == (75.0, "largest stored energy")
    assert kept["energy_error"] <= 1e-12
    assert kept["linear_momentum_drift_relative"] is None
    assert "momentum" not in answer(run).lines[-1].text


def test_where_nothing_is_there_is_no_relative_error():
    kept = conserved(simulate(arm(), duration=0.1))
    assert (kept["energy_error"], kept["energy_scale"], kept["energy_error_relative"]) == (0.0, 0.0, None)


def test_pieces_of_a_run_have_ledgers_of_their_own():
    whole = swing(0.5, 1.0)
    system = arm(springs={"hinge": JointSpring(joint="hinge", stiffness=STIFFNESS)})
    state, settings = None, RunSettings(output_rate=100.0)
    for k in range(20):  # some of them begin and end at rest
        first = {"start": state} if k else {"q": at(0.5), "angles": {"hinge": 0.5}}
        run = simulate(system, duration=0.05, settings=settings, **first)
        assert run.outcome is Outcome.COMPLETED, run.message
        state = run.end
    assert run.data["q"].values[-1] == pytest.approx(whole.data["q"].values[-1], abs=1e-12)


# --- the alarm ---


def test_an_open_ledger_is_an_outcome_that_says_when_how_much_and_where():
    run = opened(lying(0.5055, 0.03))
    assert run.outcome is Outcome.LEDGER_OPEN
    assert not run.completed
    assert run.data["time"].values[-1] == 1.0  # all samples are kept
    # Half of 0.6 kg m^2 turns at 1 rad/s: 0.3 J.
    said = (
        "at t = 0.506 s the energy balance is off by 30 mJ (at most 30 mJ, 0.1 of the largest kinetic energy)"
    )
    assert plain(run.message).startswith(said)
    assert "happened since 0.505 s: no event; changed most: forces.line" in run.message
    assert answer(run).ended.startswith("ledger open, ")
    assert "balance is off by 30 mJ" in plain(answer(run).lines[-1].text)


@pytest.mark.parametrize("energy", [1e-3, 1e-5])
def test_an_error_far_below_what_is_seen_is_found(energy):
    """The tolerance explains 1e-8 (300 + 0.2 N) of 0.3 J and the 0.6 J of a rate that is off by its scale."""
    kept = conserved(opened(lying(0.5, energy)))
    assert kept["energy_error"] == pytest.approx(energy, rel=1e-6)
    assert kept["energy_tolerance"] < 4e-6


def test_what_happened_is_named():
    """An event at 0.4 s, and a ledger that opens with it; an event before is not named."""
    line = lying(0.4, 0.03)
    springs = {"hinge": JointSpring(joint="hinge", stiffness=1.0)}
    system = System(line.mechanism, springs=springs, elements={"forces": dict(line.forces)})
    events = [
        Event(name=name, when=Time(t), action=Set("springs.hinge.stiffness", 1.0 + t))
        for name, t in (("early", 0.2), ("late", 0.4))
    ]
    run = opened(system, events=events)
    assert run.message.startswith("at t = 0.4 s the energy balance is off by")
    assert ": event 'late'; changed most: " in run.message


def test_the_alarm_can_be_set_and_switched_off():
    system = lying(0.5, 0.03)
    how: dict[str, Any] = {"duration": 1.0, "v": [1.0]}
    off = simulate(system, **how, settings=RunSettings(ledger_alarm=False))
    assert off.outcome is Outcome.COMPLETED
    assert "balance is off by 30 mJ" in plain(answer(off).lines[-1].text)  # it is not said to be well
    wide = simulate(system, **how, settings=RunSettings(ledger_tolerance=0.2))
    assert wide.outcome is Outcome.COMPLETED
    assert conserved(wide)["energy_tolerance"] == pytest.approx(0.2 * 0.3, rel=1e-6)
    with pytest.warns(LedgerOpenWarning, match="where integrator.ledger_tolerance allows 15.mJ"):
        simulate(system, **how, settings=RunSettings(ledger_tolerance=0.05))
    for wrong in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(InvalidParameterError, match="ledger_tolerance must be positive"):
            RunSettings(ledger_tolerance=wrong)


def test_fixed_steps_have_a_bound_of_their_own():
    """Nobody has asked them for an accuracy. Of its energy a step loses (omega h)^6 / 72: 4 % in all."""
    good = swing(0.5, method="rk4", step=1e-3)
    assert good.outcome is Outcome.COMPLETED
    assert conserved(good)["energy_tolerance"] == pytest.approx(FIXED_STEP * 75.0, rel=1e-9)
    with pytest.warns(LedgerOpenWarning):
        poor = swing(0.5, method="rk4", step=2e-2, max_step=2e-2)
    lost = 1.0 - (1.0 - (2e-2 * math.sqrt(STIFFNESS / INERTIA)) ** 6 / 72.0) ** 50
    # To the next order in omega h: a tenth.
    assert conserved(poor)["energy_error_relative"] == pytest.approx(lost, rel=0.2)


# --- wherever a run goes ---


def test_a_result_is_the_same_however_it_is_kept(tmp_path, monkeypatch):
    """In memory, lean, in parts on the disk, and read again."""
    system, how = lying(0.5055, 0.03), {"duration": 1.0, "v": [1.0]}
    whole = opened(system)
    lean = opened(system, settings=RunSettings(output_form="lean"))
    assert (lean.outcome, lean.message) == (whole.outcome, whole.message)
    monkeypatch.setattr(checkpoint, "_PART", 10_000)
    with pytest.warns(LedgerOpenWarning):
        parts = simulate(system, **how, out=tmp_path / "a.nc")
    assert (parts.outcome, parts.message) == (whole.outcome, whole.message)
    assert not (tmp_path / "a.nc.parts").exists()
    again = Trajectory.load(tmp_path / "a.nc")
    assert (again.outcome, again.message, again.completed) == (whole.outcome, whole.message, False)
    assert conserved(again) == conserved(whole)


def test_it_goes_on_from_a_run_whose_ledger_is_open():
    """All that it has is there; what comes has a ledger of its own, which closes."""
    system = lying(0.5, 0.03)
    run = opened(system)
    after = simulate(system, start=run.end, duration=0.5)
    assert after.outcome is Outcome.COMPLETED, after.message
    assert after.data["time"].values[0] == 1.0


def test_a_session_goes_on_while_its_record_is_judged():
    session = start(lying(0.5, 0.03), v=[1.0])
    assert session.step(0.8)
    with pytest.warns(LedgerOpenWarning):
        assert session.trajectory().outcome is Outcome.LEDGER_OPEN
    assert session.outcome is Outcome.COMPLETED
    assert session.step(0.2)


def test_a_result_of_before_says_what_it_can(tmp_path):
    """Files that have no bound: a balance that is off by more than a thousandth is not said to close."""
    run = swing(0.5)
    run.save(tmp_path / "a.nc")
    for error, said in ((1e-9, "closes to 1 nJ"), (0.5, "is off by 0.5 J")):
        old = dict(conserved(run), energy_error=error, energy_error_relative=error / 75.0)
        for name in ("energy_tolerance", "linear_momentum_tolerance", "angular_momentum_tolerance"):
            del old[name]
        there = Trajectory.load(tmp_path / "a.nc")
        there = dataclasses.replace(there, data=there.data.assign_attrs(conservation=json.dumps(old)))
        there.save(tmp_path / "old.nc")
        assert f"balance {said}" in plain(answer(Trajectory.load(tmp_path / "old.nc")).lines[-1].text)
