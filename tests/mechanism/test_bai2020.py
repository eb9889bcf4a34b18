"""The shipped antenna has the numbers of Bai and Zhao 2020 and what follows from them."""

import math
import runpy
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trimesh

from antenna_pin.mechanism import build_mechanism

ROOT = Path(__file__).resolve().parents[2]

# Table 1 in the paper's own local axes, and these axes (columns) in those of our links.
TABLE_1 = {
    "body": (2400.0, (400.0, 328.0, 328.0), np.eye(3)),
    "shaft1": (4.712, (0.1011, 0.1011, 0.00589), np.eye(3)),
    "shaft2": (4.712, (0.1011, 0.1011, 0.00589), pin.exp3(np.array([-math.pi / 2, 0.0, 0.0]))),  # z to y
    "reflector": (8.005, (0.68297, 1.05956, 0.68297), pin.exp3(np.array([0.0, 0.0, -math.pi / 2]))),  # y to x
}


@pytest.mark.parametrize("link", TABLE_1)
def test_masses_and_inertias_are_those_of_table_1(antenna, link):
    mass, moments, turn = TABLE_1[link]
    inertial = antenna.link(link).inertial
    assert inertial.mass == mass
    assert np.abs(inertial.inertia - turn @ np.diag(moments) @ turn.T).max() < 1e-15 * max(moments)


def test_the_layout(antenna):
    """Mass centres and joints at zero angles, from the body's mass centre."""
    mechanism = build_mechanism(antenna)
    data = mechanism.model.createData()
    pin.framesForwardKinematics(mechanism.model, data, pin.neutral(mechanism.model))
    centres = {}
    for name in TABLE_1:
        origin = antenna.link(name).inertial.origin
        local = np.zeros(3) if origin is None else origin[:3, 3]
        centres[name] = data.oMf[mechanism.frame(name)].act(local)
    assert np.allclose(centres["body"], (0.0, 0.0, 0.0), atol=0.0)
    assert np.allclose(centres["shaft1"], (0.0, 0.0, 0.75), atol=1e-15)
    assert np.allclose(centres["shaft2"], (0.0, 0.25, 1.0), atol=1e-15)
    assert np.allclose(centres["reflector"], (0.0, 0.5, 1.0), atol=1e-15)
    assert np.allclose(data.oMi[mechanism.joint("azimuth").joint_id].translation, (0.0, 0.0, 0.5), atol=1e-15)
    assert np.allclose(
        data.oMi[mechanism.joint("elevation").joint_id].translation, (0.0, 0.0, 1.0), atol=1e-15
    )
    assert mechanism.joint("azimuth").axis.tolist() == [0.0, 0.0, 1.0]
    assert mechanism.joint("elevation").axis.tolist() == [0.0, 1.0, 0.0]
    assert mechanism.bodies == ("body", "shaft1", "shaft2")
    assert pin.computeTotalMass(mechanism.model) == pytest.approx(2400.0 + 2 * 4.712 + 8.005, rel=1e-15)


def test_what_the_motors_turn(antenna):
    """About the elevation axis the bodies' own moments alone, at any angles: all mass centres lie on it."""
    mechanism = build_mechanism(antenna, "fixed")
    model, data = mechanism.model, mechanism.model.createData()
    azimuth, elevation = mechanism.joint("azimuth").v, mechanism.joint("elevation").v
    rng = np.random.default_rng(2)
    for q in rng.uniform(-3.0, 3.0, (5, 2)):
        mass_matrix = np.array(pin.crba(model, data, q))
        assert mass_matrix[elevation, elevation] == pytest.approx(0.00589 + 0.68297, rel=1e-14)
    # About the azimuth axis at zero angles, by parallel axes.
    inertia = float(np.array(pin.crba(model, data, pin.neutral(model)))[azimuth, azimuth][0, 0])
    assert inertia == pytest.approx(0.00589 + 0.1011 + 4.712 * 0.25**2 + 0.68297 + 8.005 * 0.5**2, rel=1e-14)
    # README's mean drift rates M0 / (2 pi I), base held, to the digits given there.
    assert 4.0 / (2 * math.pi * mass_matrix[elevation, elevation][0, 0]) == pytest.approx(0.924, abs=5e-4)
    assert 10.0 / (2 * math.pi * inertia) == pytest.approx(0.516, abs=5e-4)


def test_boxes_and_tubes_have_the_inertia_of_the_table(antenna):
    """The shapes that are drawn: a box of 3000 kg/m^3 and solid cylinders of 1200 kg/m^3 (README)."""

    def drawn(link, name):
        return next(visual.geometry for visual in antenna.link(link).visuals if visual.name == name)

    a, b, c = drawn("body", "box").box.size
    mass, moments, _ = TABLE_1["body"]
    assert 3000.0 * a * b * c == pytest.approx(mass, rel=1e-14)
    squares = (b * b + c * c, a * a + c * c, a * a + b * b)
    assert [mass / 12.0 * square for square in squares] == pytest.approx(moments, rel=1e-14)
    for link in ("shaft1", "shaft2"):
        mass, (across, _, along), _ = TABLE_1[link]
        r = drawn(link, "tube").cylinder.radius
        tube = 1200.0 * math.pi * r**2 * 0.5
        assert tube == pytest.approx(mass, abs=5e-4)  # the table's digits
        assert tube * (3.0 * r**2 + 0.5**2) / 12.0 == pytest.approx(across, abs=5e-5)
        assert tube * r**2 / 2.0 == pytest.approx(along, abs=5e-6)


def test_the_dish_is_a_closed_shell_with_the_reflectors_mass_and_inertia(antenna):
    """So the paraboloid that is drawn could be the body that is simulated."""
    mesh = trimesh.load_mesh(ROOT / "models" / "bai2020" / "dish.obj")
    assert mesh.is_watertight and mesh.is_winding_consistent
    # 5.2 mm of 1200 kg/m^3, the shafts' density: to the thickness' rounding (1 %) and the facets (0.5 %).
    assert 1200.0 * mesh.volume == pytest.approx(8.005, rel=0.015)
    mesh.density = 8.005 / mesh.volume
    # Radius and focal length are rounded to a millimetre: 0.3 %; 48 facets a turn: 0.3 %.
    assert np.diag(mesh.moment_inertia) == pytest.approx([1.05956, 0.68297, 0.68297], rel=0.007)
    visual = antenna.link("reflector").visuals[0]
    assert visual.geometry.mesh.filename == "dish.obj"
    # Its centre of mass is the link's, to the 0.1 mm that the URDF gives.
    assert np.abs(mesh.center_mass + visual.origin[:3, 3]).max() < 1e-4


def test_the_script_writes_the_mesh_that_is_shipped(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["make_dish.py", "--out", str(tmp_path / "dish.obj")])
    runpy.run_path(str(ROOT / "scripts" / "make_dish.py"), run_name="__main__")
    assert (tmp_path / "dish.obj").read_bytes() == (ROOT / "models" / "bai2020" / "dish.obj").read_bytes()


def test_shapes_that_make_up_the_joint_have_table_2s_dimensions(antenna):
    def cylinders(link):
        return {
            s.name: (s.geometry.cylinder.radius, s.geometry.cylinder.length)
            for s in link.visuals
            if s.geometry.cylinder
        }

    assert cylinders(antenna.link("shaft1"))["bearing"] == (0.010 + 0.002, 0.050)
    assert cylinders(antenna.link("shaft2"))["journal"] == (0.0098, pytest.approx(0.050 + 2 * 0.0002))
    assert cylinders(antenna.link("shaft2"))["flange_outer"] == (0.014, 0.002)
    for link in ("body", "shaft1", "shaft2", "reflector"):
        named = {shape.name: shape for shape in antenna.link(link).visuals}
        for shape in antenna.link(link).collisions:  # each solid shape is drawn as it is
            assert shape.geometry == named[shape.name].geometry


def test_the_urdf_says_where_each_number_comes_from(antenna):
    lines = antenna.to_xml().splitlines()
    numbers = [line for line in lines if "<mass " in line or "<inertia " in line or "<axis " in line]
    assert len(numbers) == 10
    assert all("<!-- Table" in line or "<!-- assumed" in line for line in numbers)
    assert antenna.not_simulated == ()
