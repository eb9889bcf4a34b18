"""Contact stress of runs: by hand from the recorded forces, in every kind of joint, and refusals."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import SurfaceFile, contact_stress, read_surfaces
from antenna_pin.analysis.contact_stress import ball_loads, flank_stress
from antenna_pin.analysis.surface_stress import Pair, StressCriteria
from antenna_pin.contact import MATERIALS, effective_modulus, hertz_line, persson_line
from antenna_pin.elements import BallBearing
from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.quantities import QUANTITIES
from antenna_pin.studies.verification.quantity import Case

STRONG = {"materials.steel.yield_strength": "300 MPa"}


@pytest.fixture(scope="module")
def pendulum():
    """The first impact of a journal in its bore, 5 ms."""
    return simulate(load_scenario("pendulum", overrides=STRONG), duration=0.006)


def hand(run):
    """Radii, length and modulus of the pendulum's joint."""
    joint = run.scenario.clearance["hinge"]
    steel = run.scenario.material("steel")
    outer, play = joint.bearing_radius, joint.radial_play
    return outer, outer - play, joint.bearing_length, effective_modulus(steel, steel)


def test_a_bore_is_a_line_under_the_recorded_force(pendulum):
    found = contact_stress(pendulum)
    row = found.surface("hinge.radial+")
    outer, inner, length, modulus = hand(pendulum)
    force = float(pendulum.data["normal_force"].sel(contact="hinge.radial+").max())
    assert row.force == pytest.approx(force, rel=1e-9)  # peaks are samples
    line = hertz_line(force / (0.5 * length), 1.0 / inner - 1.0 / outer, modulus)
    assert row.pressure == pytest.approx(float(line.pressure), rel=1e-6)
    assert row.half_width == pytest.approx(float(line.half_width), rel=1e-6)
    assert row.history.max() == pytest.approx(row.pressure, rel=1e-9)
    assert row.share == pytest.approx(row.pressure / 300e6, rel=1e-12)
    assert row.margin == pytest.approx(0.93 * 300e6 / row.pressure - 1.0, rel=1e-12)
    assert any("softer" in note for note in row.notes)  # the point law of a bore, by a factor of four
    assert found.worst.place in ("hinge.radial+", "hinge.radial-")


def test_the_share_and_the_factor_are_parameters(pendulum):
    usual, strict = (
        contact_stress(pendulum, **more).worst for more in ({}, {"yield_share": 0.5, "factor": 1.25})
    )
    assert (1.0 + strict.margin) / (1.0 + usual.margin) == pytest.approx(0.5 / 0.93 / 1.25, rel=1e-12)


def test_a_wide_contact_is_conformal(pendulum):
    row = contact_stress(pendulum, conformal_above=0.01).surface("hinge.radial+")
    outer, inner, length, modulus = hand(pendulum)
    load = row.force / (0.5 * length)
    expected = persson_line(load, math.sqrt(outer * inner), outer - inner, modulus)
    assert row.theory.startswith("Persson") and "above 0.01" in row.theory
    assert row.pressure == pytest.approx(float(expected.pressure), rel=1e-6)


def test_pv_is_force_over_projected_area_times_slip(pendulum):
    (bush,) = contact_stress(pendulum).bushings
    outer, _, length, _ = hand(pendulum)
    force = np.linalg.norm(pendulum.data["joint_force"].values[:, 0, :2], axis=1)
    assert bush.pressure == pytest.approx(force.max() / (2.0 * outer * length), rel=1e-12)
    assert 0.0 < bush.mean_pv < bush.pv <= bush.pressure * bush.speed


def test_a_bearing_on_the_child_has_the_same_pressure():
    """The same impact, but the play is measured from the other part: 0.1 mm over centimetres."""
    pressures = []
    for side in ("parent", "child"):
        changes = {**STRONG, "clearance.hinge.bearing_on": side}
        run = simulate(load_scenario("pendulum", overrides=changes), duration=0.006)
        pressures.append(contact_stress(run).surface("hinge.radial+").pressure)
    assert pressures[1] == pytest.approx(pressures[0], rel=5e-3)


def test_balls_of_a_bearing_carry_its_preload_and_an_outside_force():
    """In the reference position each ball has F_a / (Z sin alpha); pushed aside they sum to the force."""
    bearing = BallBearing(
        joint="shaft", count=12, ball_diameter=0.004, pitch_diameter=0.03, contact_angle=math.radians(15.0),
        preload=40.0, arrangement="back-to-back", spread=0.02, by="balls",
    )  # fmt: skip
    loads = ball_loads(bearing, np.zeros((1, 3)), np.zeros((1, 3)))
    assert loads == pytest.approx(np.full((1, 24), 40.0 / (12 * math.sin(bearing.loaded_angle))), rel=1e-9)
    shift = 1e-9
    moved = ball_loads(bearing, np.array([[shift, 0.0, 0.0]]), np.zeros((1, 3)))
    balls = bearing.balls()
    off, along = balls[:, 4] + balls[:, 0] * shift, balls[:, 5]
    force = float((moved[0] * off / np.hypot(off, along) * balls[:, 0]).sum())
    # Stiffness at the preload, which the law's curvature changes by some 1e-4 over a nanometre.
    assert force == pytest.approx(bearing.stiffness[0, 0] * shift, rel=1e-3)


def test_flanks_are_cylinders_at_the_pitch_point():
    """20 and 40 mm under 20 deg: 1/R* = (1/20 + 1/40) / sin 20; the normal force is F_t / cos 20."""
    surfaces = SurfaceFile(
        gears={
            "train": {
                "input_radius": "20 mm",
                "output_radius": "40 mm",
                "width": "8 mm",
                "materials": ["steel-440c", "steel-440c"],
            }
        }
    )
    pair = Pair.of("steel-440c", "steel-440c", MATERIALS.__getitem__)
    about = {"gears.train": {"kind": "Gear", "slides": False, "joint": None, "modes": [], "numbers": {}}}
    data = xr.Dataset(
        {"element_effort": (("time", "element"), [[0.0], [-2.0], [1.0]])},
        coords={"time": [0.0, 0.1, 0.2], "element": ["gears.train"]},
        attrs={"elements": json.dumps(about)},
    )
    limits = StressCriteria(yield_share=1.0, factor=1.0, conformal_above=1.0)
    row = flank_stress(data, "train", surfaces.gears["train"], pair, "output", limits)
    angle = math.radians(20.0)
    force = 2.0 / 0.04 / math.cos(angle)
    expected = hertz_line(force / 0.008, (1 / 0.02 + 1 / 0.04) / math.sin(angle), pair.modulus)
    assert (row.time, row.force) == pytest.approx((0.1, force), rel=1e-12)
    assert row.pressure == pytest.approx(float(expected.pressure), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[stops.a]\nradius = '5 mm'", "stops.a.materials is missing"),
        (
            "[stops.a]\nradius = '5 N'\nmaterials = ['steel', 'steel']",
            r"stops.a.radius must be a length \[m\]",
        ),
        ("[joint.a]", "joint is unknown; did you mean joints?"),
        (
            "[stops.a]\nradius = 1\nhollow_radius = 1\nmaterials = ['steel', 'steel']",
            "hollow_radius must be above",
        ),
    ],
)
def test_a_file_of_surfaces_is_refused_in_one_line(tmp_path, text, words):
    path = tmp_path / "surfaces.toml"
    path.write_text(text)
    with pytest.raises(ScenarioError, match=words):
        read_surfaces(path)


def test_unknown_names_are_refused(pendulum):
    with pytest.raises(UnknownNameError, match="clearance joint 'hing' is unknown"):
        contact_stress(pendulum, joint="hing")
    with pytest.raises(UnknownNameError, match="material 'cheese' is unknown"):
        contact_stress(pendulum, surfaces=SurfaceFile(joints={"hinge": {"bearing_material": "cheese"}}))
    with pytest.raises(UnknownNameError, match="stop 'hinge' is unknown"):
        contact_stress(
            pendulum, surfaces=SurfaceFile(stops={"hinge": {"radius": 0.01, "materials": ["steel", "steel"]}})
        )
    with pytest.raises(InvalidParameterError, match="factor must be positive and finite, got 0"):
        contact_stress(pendulum, factor=0.0)


def test_a_pair_of_materials_takes_the_weaker_known_limit():
    pair = Pair.of("steel", "bronze-c93200", MATERIALS.__getitem__)
    assert pair.weakest == ("bronze-c93200", 125e6) and pair.unknown == ("steel",)


def test_a_law_of_the_geometry_is_no_contradiction_but_its_damping_is():
    """Persson's own line with Flores' damping at a restitution of a half: only the damping is told."""
    law = {"replace": True, "law": "persson", "dissipation": "flores", "restitution": 0.5}
    changes = {**STRONG, "clearance.hinge.normal": law, "clearance.hinge.load": "distributed"}
    run = simulate(load_scenario("pendulum", overrides=changes), duration=0.006)
    notes = contact_stress(run).surface("hinge.radial+").notes
    assert not any("approach of this geometry" in note for note in notes)
    (told,) = (note for note in notes if "% of the peak force is damping, which flores fits" in note)
    force = run.data["normal_force"].sel(contact="hinge.radial+").values
    k = int(force.argmax())
    depth, rate = (
        float(run.data[name].sel(contact="hinge.radial+").values[k]) for name in ("depth", "depth_rate")
    )
    onset = float(run.data["approach_speed"].values[0])
    # Flores: F = K depth^n (1 + 8 (1 - c) / (5 c) rate / onset): the damping's share of it, here by the rate.
    part = 1.6 * rate / onset
    assert float(told.split(" %")[0]) == pytest.approx(100.0 * part / (1.0 + part), rel=0.05) and depth > 0.0


@pytest.mark.parametrize(
    ("quantity", "of", "expected"),
    [
        ("contact_pressure", "hinge.radial+", lambda rows: rows["hinge.radial+"].pressure),
        ("contact_margin", "hinge", lambda rows: min(one.margin for one in rows.values() if one.force)),
        ("line_load_ratio", None, lambda rows: 1.0),
        ("line_load_ratio", "hinge.radial-", lambda rows: rows["hinge.radial-"].line_load_ratio),
    ],
)
def test_requirements_bound_the_stress(pendulum, quantity, of, expected):
    rows = {one.place: one for one in contact_stress(pendulum).surfaces}
    spec = RequirementSpec(quantity=quantity, of=of, at_most=1.0)
    case = Case(pendulum.scenario, lambda: pendulum)
    assert QUANTITIES[quantity].find(case, spec) == pytest.approx(expected(rows), rel=1e-9)


def test_a_stress_that_is_not_known_is_not_taken_for_none(pendulum):
    """Both halves of the bore met: the margin of the one whose limit is unknown must not drop out."""
    found = contact_stress(pendulum)
    blind = tuple(
        replace(one, margin=math.nan) if one.place == "hinge.radial-" else one for one in found.surfaces
    )
    case = Case(pendulum.scenario, lambda: pendulum, memo={"stress": replace(found, surfaces=blind)})
    spec = RequirementSpec(quantity="contact_margin", of="hinge", at_least=0.0)
    assert math.isnan(QUANTITIES["contact_margin"].find(case, spec))
    with pytest.raises(UnknownNameError, match="surface 'hing' is unknown; did you mean"):
        spec = RequirementSpec(quantity="contact_margin", of="hing", at_least=0.0)
        QUANTITIES["contact_margin"].find(case, spec)
