"""A backend of the user's, of a bore that no closed form knows: contacts are located on its gaps."""

import dataclasses
import math

import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, System, simulate
from antenna_pin.contact import CustomNormal, Hertz, Tanh
from antenna_pin.joints.geometry import PlanarClearance

STIFFNESS, MASS, RADIUS, LONG, SHORT = 1e6, 2.0, 6e-3, 11e-3, 10e-3
WAYS = {"x": (LONG - RADIUS, (1.0, 0.0)), "y": (SHORT - RADIUS, (0.0, 1.0))}


class EllipticBore:
    """A disc in an elliptic hole: its nearest point of the ellipse by Newton, in Python."""

    def query(self, pose, table, row, wanted=None):
        """Fill gap, normal and point of the one contact."""
        x, y, _ = pose[0].centre.tolist()
        angle = math.atan2(y * LONG, x * SHORT)
        for _ in range(50):
            c, s = math.cos(angle), math.sin(angle)
            # Half the derivative of the squared distance over the angle, and its derivative.
            slope = LONG * s * (x - LONG * c) - SHORT * c * (y - SHORT * s)
            curvature = (
                LONG * c * (x - LONG * c) + LONG**2 * s**2 + SHORT * s * (y - SHORT * s) + SHORT**2 * c**2
            )
            step = slope / abs(curvature)
            angle -= step
            if abs(step) < 1e-15:
                break
        point = np.array([LONG * math.cos(angle), SHORT * math.sin(angle), 0.0])
        inward = -np.array([SHORT * math.cos(angle), LONG * math.sin(angle), 0.0])
        inward /= math.hypot(*inward)
        table[row].gap = float(inward @ (np.array([x, y, 0.0]) - point)) - RADIUS
        table[row].normal = inward
        table[row].point = point


@pytest.fixture
def hole(impact_rig):
    """The rig's disc in the elliptic hole; the shape of its joint says how large it is, about."""

    def build(law, **joint):
        rig = impact_rig(law, mass=MASS)
        shape = PlanarClearance(bearing_radius=LONG, journal_radius=RADIUS)
        made = dataclasses.replace(rig.clearances[0], geometry=shape, backend=EllipticBore(), **joint)
        return System(rig.mechanism, clearances=[made])

    return build


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("way", WAYS)
def test_contacts_are_located_on_the_backends_own_gap(way, compiled, hole):
    """Along the axes a ball between two walls: half an oscillation on a linear wall, and back."""
    linear = Hertz(stiffness=STIFFNESS, exponent=1.0)
    law = (
        linear
        if compiled
        else CustomNormal(
            force=lambda depth, rate, speed: STIFFNESS * depth,
            elastic_force=linear.elastic_force,
            elastic_energy=linear.elastic_energy,
        )
    )
    free, direction = WAYS[way]
    speed, w = 0.1, math.sqrt(STIFFNESS / MASS)
    settings = RunSettings(rtol=1e-10)
    run = simulate(hole(law), duration=0.17, v=[*(speed * np.array(direction)), 0.0], settings=settings)
    onsets, releases = run.data["onset_time"].values, run.data["release_time"].values
    first = free / speed
    assert onsets[0] == pytest.approx(first, rel=0.0, abs=1e-12)
    # After a contact by the error of the run, some 1e-10 of the play a step, over the speed.
    assert onsets[1] == pytest.approx(3.0 * first + math.pi / w, rel=0.0, abs=1e-9)
    assert releases[0] == pytest.approx(first + math.pi / w, rel=0.0, abs=1e-9)
    assert run.data["peak_force"].values[0] == pytest.approx(STIFFNESS * speed / w, rel=1e-7)
    assert run.data["peak_depth"].values[0] == pytest.approx(speed / w, rel=1e-7)
    assert abs(run.data["energy_error"]).max() < 1e-8 * 0.5 * MASS * speed**2


def test_the_ledger_closes_where_the_disc_slides_along_the_ellipse(hole):
    """Thrown askew, with friction, so that it turns: a wrong normal or point would not keep energy."""
    law = Hertz(stiffness=STIFFNESS, exponent=1.5)
    friction = Tanh(coefficient_of_friction=0.2, transition_speed=1e-3)
    settings = RunSettings(rtol=1e-10)
    run = simulate(hole(law, friction=friction), duration=0.6, v=[0.13, 0.08, 2.0], settings=settings)
    assert run.outcome is Outcome.COMPLETED and run.data.sizes["episode"] > 5
    start = 0.5 * MASS * (0.13**2 + 0.08**2) + 0.5 * 0.01 * 2.0**2
    assert abs(run.data["energy_error"]).max() < 1e-7 * start
    assert run.data["dissipation_friction"].values[-1].sum() > 0.01 * start


def test_two_halves_are_the_whole_on_a_backends_gap(hole):
    system = hole(Hertz(stiffness=STIFFNESS, exponent=1.5))
    v = [0.13, 0.08, 2.0]
    whole = simulate(system, duration=0.2, v=v)
    first = simulate(system, duration=0.083, v=v)
    later = simulate(system, duration=0.2 - first.end.reached, start=first.end)
    assert later.end == whole.end


def test_too_deep_is_seen_on_the_backends_gap(hole):
    system = hole(Hertz(stiffness=1e3, exponent=1.0), maximum_depth=1e-4)
    run = simulate(system, duration=1.0, v=[0.0, 0.1, 0.0])
    assert run.outcome is Outcome.TOO_DEEP
    # On the wall at the short axis, a tenth of a millimetre in.
    assert run.data["q"].values[-1, 1] == pytest.approx(SHORT - RADIUS + 1e-4, rel=0.0, abs=1e-12)
