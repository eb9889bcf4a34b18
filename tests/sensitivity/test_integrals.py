"""What a run integrates, and what blows take, by the equation: losses, impulses, peaks and instants."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import pointing_indices
from antenna_pin.studies.sensitivity import sensitivities
from tests.sensitivity.test_closed_forms import (
    BALL,
    COIL,
    DAMPING,
    FLOOR,
    KEYS,
    MASS,
    PLACE,
    PULL,
    SCALES,
    SPEED,
    STIFFNESS,
    bounces,
    mass,
    oscillation,
    stepped_numbers,
)

PLAIN = {"clearance.bore.geometry": "closed-form", "integrator.engine": "compiled"}


def blows(restitution, floor, speed, pull):
    """Return instant, loss and impulse of each blow of the ball, which are analytic in all arguments."""
    instants = bounces(1.4, restitution, floor, speed, pull)[2]
    arrivals, last, rate = [], 0.0, speed + 0.0 * floor
    for instant in instants:
        arrivals.append(rate - pull * (instant - last))
        last, rate = instant, -restitution * arrivals[-1]
    losses = [0.5 * MASS * (1.0 - restitution**2) * one**2 for one in arrivals]
    impulses = [-MASS * (1.0 + restitution) * one for one in arrivals]
    return instants, losses, impulses


def test_what_blows_take(tmp_path):
    """Of each its instant, loss (1 - e^2) m v^2 / 2 and impulse m (1 + e) v; and the sum of losses."""
    found = sensitivities(mass(tmp_path, FLOOR), SCALES, [0.7, 1.4], method="equation")
    for k, value, stepped in stepped_numbers(BALL):
        sign = -1.0 if value == PULL else 1.0
        for name, exact in zip(
            ("change_time", "change_loss", "change_impulse"), blows(*stepped), strict=True
        ):
            wanted = sign * np.array([one.imag for one in exact]) / 1e-30
            off = np.abs(found.derivative(name)[:, k] - wanted).max() * (value or 0.1)
            # Ten of the run's tolerances of 1e-12, of numbers of up to 18 per scale; differences of these
            # over steps of 1e-4 round off by 4e-11.
            assert off < 2.2e-10
        total = sum(one.imag for one in blows(*stepped)[1]) / 1e-30
        # Of three blows, each by differences of 10 J over steps of 1e-4.
        assert abs(found.derivative("total_element_loss")[0, k] - sign * total) * (value or 0.1) < 3e-10


def test_what_a_damper_takes(tmp_path):
    """The loss is what gravity and spring give less what the mass has: energy by the closed form."""
    times = np.array([0.2, 0.7, 1.4])

    def loss(stiffness, damping, mass, place, gravity):
        x, v = oscillation(times, stiffness, damping, mass, place, gravity)

        def energy(x, v):
            return 0.5 * mass * v**2 + 0.5 * stiffness * x**2 - mass * gravity * x

        return energy(place, SPEED) - energy(x, v)

    found = sensitivities(mass(tmp_path, COIL), list(KEYS), times, method="equation")
    for k, value, stepped in stepped_numbers(KEYS):
        exact = loss(*stepped).imag / 1e-30
        ours = found.derivative("dissipation_damper")[:, 0, k]
        # A hundred of the run's tolerances of energies of some 20 J.
        assert np.abs(ours - exact).max() * abs(value) < 2e-9


SOFT, CUSHION = 2e3, 20.0  # [N/m], [N s/m]


def cushioned(stiffness, damping, mass, speed):
    """Return loss and impulse of the ball on a floor that gives way: ``K d + D d'``, never pulling.

    It presses up to t, where that is zero at a depth d; from there on the ball flies.
    """
    arrives = np.sqrt(speed**2 + 2.0 * PULL * PLACE)
    rest, half = mass * PULL / stiffness, 0.5 * damping / mass
    omega = np.sqrt(stiffness / mass - half**2)
    a, b = -rest, (arrives - half * rest) / omega

    def inside(t):
        wave, turned = np.cos(omega * t), np.sin(omega * t)
        slope = omega * (b * wave - a * turned) - half * (a * wave + b * turned)
        return rest + np.exp(-half * t) * (a * wave + b * turned), np.exp(-half * t) * slope

    t = (0.9 * np.pi / omega).real + 0j
    for _ in range(8):  # Newton's, of which the last two make the imaginary part: by m d'' = m g there
        depth, rate = inside(t)
        t -= (stiffness * depth + damping * rate) / (stiffness * rate + damping * PULL)
    depth, rate = inside(t)
    return 0.5 * mass * (arrives**2 - rate**2 + 2.0 * PULL * depth), mass * (arrives - rate + PULL * t)


def test_what_a_stop_that_gives_way_takes(tmp_path):
    """From touch to release, with a force that jumps where it is touched; and that as a total."""
    floor = f"""
[stops.floor]
joint = "way"
lower = "0 m"
upper = "9 m"
stiffness = "{SOFT} N/m"
law = "kelvin-voigt"
damping = "{CUSHION} N*s/m"
"""
    keys = {
        "stops.floor.stiffness": SOFT,
        "stops.floor.damping": CUSHION,
        "mechanism.links.mass.mass": MASS,
        "initial.joints.way.velocity": SPEED,
    }
    found = sensitivities(mass(tmp_path, floor), list(keys), [0.7], method="equation")
    data = found.run.data
    off = data["change"].values.tolist().index("stop floor: lower: off")
    names = ("change_loss", "change_impulse")
    for name, exact in zip(names, cushioned(*keys.values()), strict=True):
        assert data[name].values[off] == pytest.approx(exact.real, rel=1e-10)
    for k, value, stepped in stepped_numbers(keys):
        exact = cushioned(*stepped)
        for name, place, one in zip(
            (*names, "total_element_loss"), (off, off, 0), (*exact, exact[0]), strict=True
        ):
            ours, doubt = (each(name)[place, k] for each in (found.derivative, found.doubt))
            # Some 10 J and 10 N s per scale; the run goes over the kink where the force is cut.
            assert abs(ours - one.imag / 1e-30) * value < 1e-7
            assert abs(ours - one.imag / 1e-30) <= doubt


@pytest.mark.parametrize("method", ["runs", "equation"])
def test_pointing_indices(tmp_path, method):
    """The largest error of an oscillator and its mean over a window, by the closed form at the same times."""
    times, key = np.linspace(0.0, 1.4, 29), "springs.coil.damping"

    def indices(time, error):
        found = pointing_indices(time, error, window=0.7)
        return found["extreme"].sel(index=["APE", "MPE"]).values[:, 0]

    found = sensitivities(mass(tmp_path, COIL), [key], times, method=method)
    ours, doubt = found.of(lambda data: indices(data["time"].values, data["slide_position"].values[:, 0]))
    h = 1e-4
    ahead, behind = (
        indices(times, oscillation(times, STIFFNESS, DAMPING + side * h, MASS, PLACE, -PULL)[0])
        for side in (1, -1)
    )
    # Central differences of the closed form: h^2 / 6 of a third derivative of 0.05; round-off over h.
    assert np.abs(ours[..., 0] - (ahead - behind) / (2.0 * h)).max() < 1e-9 + doubt.max()
    assert doubt.max() < 1e-6


@pytest.mark.parametrize("after", [None, 1.1e-3], ids=["from the start", "from within a contact"])
def test_contacts_by_both_methods(after):
    """Impulses, losses, largest forces and depths of a blow; and over the state that a run starts from."""
    pair = load_scenario("impact_pair", overrides=PLAIN)
    start = None if after is None else simulate(pair, duration=after).end
    keys = ["clearance.bore.radial_clearance", "initial.joints.bore.journal_velocity[0]"]
    times = [1.15e-3, 2e-3]
    runs, equation = (
        sensitivities(pair, keys, times, start=start, method=one) for one in ("runs", "equation")
    )
    # The journal's mass: what moves it more moves all of it more, within a contact too.
    momentum = equation.data["linear_momentum"].values[:, 0]
    assert np.abs(equation.derivative("linear_momentum")[:, 0, 1] - momentum / 0.1).max() < 1e-8
    names = (
        "impulse",
        "dissipated",
        "peak_force",
        "peak_depth",
        "approach_speed",
        "onset_time",
        "release_time",
    )
    for name in (*names, "normal_impulse", "dissipation_normal", "total_normal_loss"):
        theirs, ours = runs.relative(name), equation.relative(name)
        known = np.isfinite(ours)
        assert known.all() or (after is not None and name.startswith("peak_"))  # which are before
        # Runs: their tolerance over a step of 1e-3, ten times; next to an onset the equation's 1e-8.
        # A largest force is located to a millionth of a step, over which its derivative changes as much.
        size = max(np.abs(theirs).max(), np.abs(runs.data[name].values).max())
        assert np.abs(ours - theirs)[known].max(initial=0.0) < (1e-6 if name == "peak_force" else 3e-8) * size


def test_contacts_that_begin_and_end_at_once():
    """Of both rims of a bore each takes half; each goes by the neighbour's own instants, as by runs."""
    pair = load_scenario("impact_pair", case="contact", overrides=PLAIN)
    keys = ["clearance.bore.normal.restitution", "materials.steel.young"]
    runs, equation = (sensitivities(pair, keys, [2e-3], method=one) for one in ("runs", "equation"))
    onsets, releases = (equation.run.data[name].values for name in ("onset_time", "release_time"))
    assert len(onsets) == 2 and max(np.ptp(onsets), np.ptp(releases)) < 1e-11
    for name in ("impulse", "dissipated"):
        theirs, ours = runs.relative(name), equation.relative(name)
        # As for one contact; and both rims are alike.
        assert np.abs(ours - theirs).max() < 3e-8 * np.abs(equation.run.data[name].values).max()
        assert np.abs(np.diff(ours, axis=0)).max() < 1e-8 * np.abs(ours).max()


def test_an_impulse_of_a_force_that_begins_at_once():
    """A linear damper presses from the onset on: a play delays a blow, and does nothing to what it gives."""
    law = "{ law = 'kelvin-voigt', stiffness = 1e7, damping = 500.0, replace = true }"
    changes = PLAIN | {"clearance.bore.normal": law}
    pair = load_scenario(
        "impact_pair", case="planar", overrides=[f"{key}={one}" for key, one in changes.items()]
    )
    play = "clearance.bore.radial_clearance"
    found = sensitivities(pair, [play], [2.5e-3], method="equation")
    # Over a play: round-off of the radii, 2e-18 m, over steps of differences of 1e-10 m.
    for name in ("impulse", "dissipated"):
        size = abs(float(found.run.data[name].values[0]))
        assert size > 0.0 and abs(found.relative(name)[0, 0]) < 1e-7 * size


def test_a_piece_is_a_run_from_its_start():
    """Derivatives over each piece, of which the first is the run itself and the next goes on from its end."""
    pair = load_scenario("impact_pair", overrides=PLAIN)
    key = "clearance.bore.normal.restitution"
    whole = sensitivities(pair, [key], [1.5e-3, 2e-3, 4e-3], method="quick-runs")
    parts = sensitivities(pair, [key], [1.5e-3, 4e-3], pieces="2 ms", method="quick-runs")
    assert parts.data["time"].values.tolist() == [1.5e-3, 2e-3, 4e-3]
    assert parts.data["piece_begin"].values.tolist() == [0.0, 0.0, 2e-3]
    ours, theirs = parts.derivative("v")[..., 0], whole.derivative("v")[..., 0]
    # Central differences of steps of 1e-4 of both; the run of a piece is cut where it ends.
    assert np.abs(ours - theirs)[:2].max() < 1e-6
    # The second blow from the same state: restitution acts once, and the arrival is not displaced.
    approach = float(whole.run.data["approach_speed"].values[1])
    assert abs(np.abs(ours[2]).max() - 0.5 * approach) < 0.2 * approach < np.abs(theirs[2]).max()


def test_how_far_derivatives_are_known():
    """Those of a motion that is far from a graze are known to the end, and grow slowly."""
    pair = load_scenario("impact_pair", overrides=PLAIN)
    key = "clearance.bore.normal.restitution"
    (told,) = sensitivities(pair, [key], np.linspace(2e-3, 20e-3, 10), method="quick-runs").growth()
    assert told.key == key and told.believed == np.inf and abs(told.exponent) < 200.0
