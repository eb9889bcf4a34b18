"""Closed loops against maximal coordinates, tests/reference, which share nothing with the package.

Both integrate to 1e-12 relative; what is left over a second is 1e-9 at most in either, so 1e-8 is asked.
"""

from functools import partial

import five_legs
import numpy as np
import pytest
from closed_arm import closed_arm
from scipy.spatial.transform import Rotation
from single_loops import bricard, four_bar, spatial_slider_crank

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_poses, body_twists

KINDS = ("spherical", "revolute", "universal", "prismatic", "cylindrical", "planar", "fixed")

LOOPS = {"four_bar": four_bar, "bricard": bricard, "spatial_slider_crank": spatial_slider_crank}
LOOPS |= {f"arm_{kind}": partial(closed_arm, kind) for kind in KINDS}

# Closures of the scenario among the joints of the reference, and how many of their loads are not unique.
CLOSURES = {
    "four_bar": {"rocker_pin": 3},
    "bricard": {"pin_6": 1},
    "spatial_slider_crank": {"ball": 0, "cross": 0},
    "five_legs": {"s2": 0, "s3": 0, "s4": 0, "s5": 0},
    **{f"arm_{kind}": {"closure": 0} for kind in KINDS},
}


def run(name, folder):
    """Return a mechanism's run by the package and by the reference."""
    if name == "five_legs":
        urdf, scenario = five_legs.urdf(), five_legs.scenario()
        system, start = five_legs.platform(), None
    else:
        loop = LOOPS[name]()
        urdf, scenario, system, start = loop.urdf, loop.scenario, loop.system, loop.start
    (folder / "loop.urdf").write_text(urdf)
    (folder / "scenario.toml").write_text(scenario)
    span = 0.25 if name.startswith("arm") else 0.5
    ours = simulate(load_scenario(folder / "scenario.toml"), duration=span).data
    return ours, system.run(ours["time"].values, start)


@pytest.mark.parametrize("name", CLOSURES)
def test_a_loop_moves_and_carries_loads_as_in_maximal_coordinates(name, tmp_path):
    """Poses and twists of bodies; loads of closures, but for what redundant rows may add to them."""
    ours, reference = run(name, tmp_path)
    poses, twists = body_poses(ours), body_twists(ours)
    assert len(ours["time"]) == (6 if name.startswith("arm") else 11)
    for body in reference.system.bodies:
        # The platform's link has its frame at its joint with leg 1.
        point = five_legs.PLATFORM_POINTS[0] if body == "platform" else (0.0, 0.0, 0.0)
        at = {"body": body}
        turn = Rotation.from_quat(poses["attitude"].sel(at).values)
        for found, expected in (
            (poses["position"].sel(at), reference.position(body, point)),
            (turn.as_matrix(), reference.rotation(body)),
            (turn.apply(twists["velocity"].sel(at).values), reference.velocity(body, point)),
            (turn.apply(twists["angular_velocity"].sel(at).values), reference.spin(body)),
        ):
            np.testing.assert_allclose(found, expected, atol=1e-8, rtol=0)
    # Some body did move, or nothing was shown.
    assert max(np.ptp(reference.position(body), axis=0).max() for body in reference.system.bodies) > 0.05
    for closure, open_ in CLOSURES[name].items():
        at = {"closure": closure}
        load = np.hstack([ours["closure_force"].sel(at).values, ours["closure_moment"].sel(at).values])
        expected = np.hstack(reference.load(closure))
        size = np.abs(expected).max()
        for row, other, ambiguous in zip(load, expected, reference.ambiguous(closure), strict=True):
            values = np.linalg.svd(ambiguous, full_matrices=False)
            kept = values.U[:, values.S > 1e-7] if ambiguous.size else np.zeros((6, 0))
            assert kept.shape[1] == open_
            difference = row - other
            difference -= kept @ (kept.T @ difference)
            assert np.abs(difference).max() < 1e-8 * size
    if name == "five_legs":
        # Drive forces of five legs, a kilonewton at most, to 1e-8 of the largest.
        largest = np.abs(reference.multipliers).max()
        for k in range(1, 6):
            effort = ours["drive_torque"].sel(drive=f"leg{k}").values
            np.testing.assert_allclose(effort, reference.drive(f"p{k}"), rtol=0, atol=1e-8 * largest)
        # In closed form, to round-off: motions are met to round-off, and nothing else is free.
        path = np.array([five_legs.path(t)[0] for t in ours["time"].values]) + five_legs.PLATFORM_POINTS[0]
        np.testing.assert_allclose(poses["position"].sel(body="platform"), path, rtol=0, atol=1e-12)
