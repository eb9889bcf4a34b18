"""Load along a tilted line of contact: closed forms, limits, geometry of joints, and the moment of a run."""

import math
from dataclasses import replace

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import contact_stress, journal_motion
from antenna_pin.analysis.strip_load import LawStrips, PlaneStrips, bore_depths, line_load
from antenna_pin.contact import Hertz, Johnson, hertz_line
from antenna_pin.joints.geometry import RevoluteClearance

FORCE, LENGTH, MODULUS, PLAY = 100.0, 0.025, 1.1e11, 5e-5
NODES = np.linspace(0.0, LENGTH, 17)[None, :]
PLANE = PlaneStrips(modulus=MODULUS, clearance=PLAY)


def under(tilt, law=PLANE, depth=0.0, nodes=NODES):
    return line_load(np.array([FORCE]), depth + tilt * nodes, nodes, law)


def balance(found, law):
    """Return force [N] and moment about x = 0 [N m] of a line by quadrature, of a depth linear in x."""
    x = np.linspace(0.0, LENGTH, 200_001)
    depth = np.interp(x, found.places[0], found.depth[0])
    scale = found.peak[0] / law.force(np.array([found.depth[0].max()]))[0]
    load = scale * law.force(np.maximum(depth, 0.0))
    return np.trapezoid(load, x), np.trapezoid(load * x, x)


@pytest.mark.parametrize("law", [PLANE, LawStrips(law=Hertz(stiffness=1e9, exponent=1.5))], ids=repr)
def test_without_tilt_the_load_is_uniform_and_a_small_tilt_tends_to_it(law):
    mean, errors = FORCE / LENGTH, []
    for tilt in (0.0, 1e-16, -1e-16, 1e-12):
        errors.append(abs(under(tilt, law, 1e-6).peak[0] / mean - 1.0))
    assert max(errors[:3]) < 1e-10
    assert 0.0 < errors[3] < 1e-5  # and is not lost


def test_a_linear_foundation_has_a_trapezium_then_a_triangle():
    """Of k (d + tilt x) the resultant is at l/2 + l^2 tilt / (12 d_mean), then a third from the end."""
    law = LawStrips(law=Hertz(stiffness=1e9, exponent=1.0))
    depth, tilt = 2e-5, 1e-3
    found = under(tilt, law, depth)
    mean = depth + 0.5 * tilt * LENGTH
    assert found.peak[0] == pytest.approx(FORCE / LENGTH * (depth + tilt * LENGTH) / mean, rel=1e-13)
    assert found.loaded[0] == pytest.approx(LENGTH, rel=1e-15)
    force, moment = balance(found, law)
    assert force == pytest.approx(FORCE, rel=1e-9)  # of the quadrature
    assert moment == pytest.approx(FORCE * (0.5 * LENGTH + LENGTH**2 * tilt / (12.0 * mean)), rel=1e-9)
    partly = under(tilt, law, -1e-5)
    touching = LENGTH - 1e-5 / tilt
    assert partly.loaded[0] == pytest.approx(touching, rel=1e-12)
    assert partly.peak[0] == pytest.approx(2.0 * FORCE / touching, rel=1e-12)
    assert balance(partly, law)[1] == pytest.approx(FORCE * (LENGTH - touching / 3.0), rel=1e-8)


@pytest.mark.parametrize("tilt", [1e-5, -1e-4, 1e-3, 0.1])
def test_a_line_that_touches_in_part_has_the_closed_form_of_its_logarithm(tilt):
    r"""With d = f w / (pi E*), w = ln(A / f) - 1: tilt F = \int f dd = f^2 (w / 2 - 1/4) / (pi E*).

    The moment about the line's inner end is \int f d dd / tilt^2; with f dd = f (w - 1) df / (pi E*) and the
    mean of d = f w / (pi E*): f^3 [w (w - 1) / 3 + (2 w - 1) / 9 + 2 / 27] / (pi E*)^2.
    """
    found = under(tilt)
    peak = found.peak[0]
    w = math.log(4.0 * math.pi * MODULUS * PLAY / peak) - 1.0
    assert abs(tilt) * FORCE == pytest.approx(peak**2 * (0.5 * w - 0.25) / (math.pi * MODULUS), rel=1e-12)
    assert found.loaded[0] == pytest.approx(peak * w / (math.pi * MODULUS) / abs(tilt), rel=1e-12)
    assert found.along[0] == (LENGTH if tilt > 0.0 else 0.0)
    inner = (
        (peak / (math.pi * MODULUS)) ** 2 * peak * (w * (w - 1.0) / 3.0 + (2.0 * w - 1.0) / 9.0 + 2.0 / 27.0)
    )
    arm = inner / tilt**2 / FORCE
    expected = FORCE * (LENGTH - found.loaded[0] + arm if tilt > 0.0 else found.loaded[0] - arm)
    assert balance(found, PLANE)[1] == pytest.approx(expected, rel=1e-4)  # of the quadrature


def test_full_misalignment_piles_all_load_up_at_the_edge():
    """The pressure grows as the fourth root of the tilt, less its logarithm: no bound, and no length."""
    first, second = (under(tilt) for tilt in (1e-4, 1e-2))
    grown = (second.peak[0] / first.peak[0]) ** 0.5
    assert 100**0.25 < grown < 1.3 * 100**0.25
    assert second.loaded[0] < 0.2 * first.loaded[0] < 0.2 * LENGTH


def test_stiffer_strips_than_johnsons_limit_go_on_as_perssons():
    """Loads and integrals on both sides of the switch, against quadrature of the inverse."""
    loads = np.geomspace(1e-6, 30.0, 4001) * MODULUS * PLAY
    depth = PLANE.depth(loads)
    assert PLANE.force(depth) == pytest.approx(loads, rel=1e-12)
    energy = np.trapezoid(loads, depth)
    assert PLANE.energy(depth[-1:])[0] == pytest.approx(energy, rel=1e-5)  # of the quadrature
    rates = np.diff(loads) / np.diff(depth)
    assert PLANE.slope(0.5 * (depth[1:] + depth[:-1]))[:3000] == pytest.approx(rates[:3000], rel=1e-5)


def test_depths_along_a_bore_are_those_of_the_joint():
    """Crossed axes; what is left out is of third order in tilt and play over length."""
    shape = RevoluteClearance.from_clearances(
        bearing_radius=0.01, radial_clearance=2e-4, bearing_length=0.05, axial_clearance=2e-4,
        bearing_outer_radius=0.012, flange_radius=0.014,
    )  # fmt: skip
    random = np.random.default_rng(7)
    for _ in range(20):
        centre = np.array([*random.uniform(-2e-4, 2e-4, 2), random.uniform(-1e-4, 1e-4)])
        axis = np.array([*random.uniform(-4e-3, 4e-3, 2), 1.0])
        axis /= np.linalg.norm(axis)
        sides = np.linspace(-1.0, 1.0, 9)
        places = 0.025 * sides[None, :]
        offset = (centre + (places[0, :, None] - centre[2]) / axis[2] * axis)[None, :, :2]
        gaps = []
        for side in sides:  # the end of a shorter bearing is a circle within
            short = replace(shape, bearing_length=max(0.05 * abs(side), 1e-9))
            gaps.append(short.contacts(centre, axis)[0 if side >= 0.0 else 1].gap)
        depth = bore_depths(offset, places, shape.bearing_radius - shape.journal_radius, shape.bearing_radius)
        assert depth[0] == pytest.approx(-np.array(gaps), abs=2e-8)


@pytest.fixture(scope="module")
def tilted():
    """A pendulum whose mass hangs beside the middle of its bore: it strikes with one end."""
    changes = {
        "clearance.hinge.load": "distributed",
        "clearance.hinge.strips": 128,
        "clearance.hinge.normal": {"replace": True, "law": "johnson"},
        "clearance.hinge.friction": {"replace": True, "law": "none"},
        "clearance.hinge.axial_clearance": "1 mm",
        "mechanism.links.bar": {"centre_of_mass": ["0 m", "10 mm", "-0.2 m"]},
    }
    return simulate(load_scenario("pendulum", overrides=changes), duration=0.0145)


def test_under_a_distributed_load_the_strips_carry_the_moment_of_the_run(tilted):
    row = contact_stress(tilted, conformal_above=1.0).surface("hinge.radial+")
    data = tilted.data.sel(time=row.time)
    assert data["normal_force"].sel(contact="hinge.radial-") == 0.0
    (plus, minus) = journal_motion(tilted)["offset"].sel(time=row.time).values
    x = np.linspace(0.0, 1.0, 2001)[:, None]
    nodes = 0.5 * (plus + minus) + 0.5 * x * (plus - minus)
    places, steel = nodes[None, :, 2], load_scenario("pendulum").material("steel")
    modulus = steel.young / (2.0 * (1.0 - steel.poisson**2))
    law = Johnson(length=0.025, bearing_radius=0.01, journal_radius=0.0099, modulus=modulus)
    depth = bore_depths(nodes[None, :, :2], places, 1e-4, 0.01)
    load = line_load(np.array([row.force]), depth, places, LawStrips(law=law)).load[0]
    # 128 strips and the third order of the depth: 7e-4.
    own = [law.elastic_force(max(one, 0.0)) / 0.025 for one in depth[0]]
    assert np.trapezoid(own, places[0]) == pytest.approx(row.force, rel=1e-3)
    # Normals are square to the journal's axis, and turn along it where the tilt is not towards the contact.
    unit = nodes * [1.0, 1.0, 0.0] / np.linalg.norm(nodes[:, :2], axis=1)[:, None]
    lean = unit @ (plus - minus) / (plus - minus)[2]
    normal = -unit + lean[:, None] * [0.0, 0.0, 1.0]
    centre = data["journal_position"].values[0]  # about which the torque is
    arms = np.cross(0.01 * unit + nodes * [0.0, 0.0, 1.0] - centre, normal)
    moment = np.trapezoid(load[:, None] * arms, places[0], axis=0)
    torque = data["joint_torque"].values[0]
    assert moment == pytest.approx(torque, abs=1e-3 * np.linalg.norm(torque))
    found = float(hertz_line(load.max(), 1.0 / 0.0099 - 1.0 / 0.01, modulus).pressure)
    assert row.pressure == pytest.approx(found, rel=1e-4)  # 16 segments


def test_an_edge_that_is_loaded_is_told(tilted):
    row = contact_stress(tilted).surface("hinge.radial+")
    assert row.edge_loaded and row.along == pytest.approx(0.025, rel=1e-12)
    assert row.line_load_ratio > 2.0 and row.loaded_length < 0.025
    assert row.profile.max() == pytest.approx(row.pressure, rel=1e-12) and row.history.max() == row.pressure
    assert any(note.startswith("edge loaded: ") for note in row.notes)
    flat = contact_stress(simulate(load_scenario("pendulum"), duration=0.006)).surface("hinge.radial+")
    assert not flat.edge_loaded and flat.line_load_ratio == pytest.approx(1.0, rel=1e-9)
    lean = load_scenario("pendulum", overrides={"output.form": "lean"})
    told = contact_stress(simulate(lean, duration=0.006)).surface("hinge.radial+")
    assert told.pressure == pytest.approx(flat.pressure, rel=1e-6)
    assert any("its tilt is not known" in note for note in told.notes)
