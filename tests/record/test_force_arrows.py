"""Forces on links as arrows of a recording: in the link's axes, at their points, at key frames."""

import base64

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import OutsideForce, Thruster
from antenna_pin.show.plot import figure_momentum
from antenna_pin.show.record import record

from .conftest import doubles, floats

BODY = """<robot name="body"><link name="body"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1.2" izz="1.5" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual></link></robot>"""


@pytest.fixture(scope="module")
def run():
    forces = {
        "jet": Thruster(
            at=("body", (0.2, 0.1, 0.0)), direction=(1, 2, 0), thrust=3.0, starts=(0.2,), durations=(0.3,)
        ),
        "drag": OutsideForce(at=("body", (0.0, 0.0, 0.1)), force=(-1.0, 0.0, 0.0), axes="world"),
        "torque": OutsideForce(at=("body", (0.0, 0.0, 0.0)), torque=(0.0, 0.0, 0.1)),
    }
    system = System(build_mechanism(Urdf.from_text(BODY, "body.urdf"), "free"), elements={"forces": forces})
    settings = RunSettings(engine="compiled", rtol=1e-10, output_rate=100.0)
    return simulate(system, duration=1.0, v=np.array([0, 0, 0, 0.3, 0.2, 1.0]), settings=settings)


def test_arrows_are_the_forces(run):
    data = record(run).data
    assert data["contacts"] is None
    items = {item["name"]: item for item in data["applied"]["items"]}
    times = doubles(data["times"])
    at = np.searchsorted(run.data["time"].values, times)
    attitude = Rotation.from_quat(run.data["base_attitude"].values[at])
    for name, item in items.items():
        force = run.data["applied_force"].sel(force_place=name).values[at]
        some = np.frombuffer(base64.b64decode(item["frames"]), dtype="<u4")
        assert np.array_equal(some, np.flatnonzero(np.any(force != 0.0, axis=1)))
        # Pages hold single precision.
        np.testing.assert_allclose(
            attitude[some].apply(floats(item["force"], 3)), force[some], rtol=0, atol=1e-6
        )
    assert np.all(floats(items["jet"]["point"], 3) == np.float32([0.2, 0.1, 0.0]))
    assert any("force on a link" in fact["text"] for fact in data["facts"])


def test_the_figure_of_momentum_takes_off_what_forces_bring_in(run):
    for axes in figure_momentum(run).axes[:2]:
        # The run's tolerance; the momenta themselves grow to some 1 N s.
        assert axes.lines[0].get_ydata().max() < 1e-8
