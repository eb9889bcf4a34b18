"""The bearing on a joint's child is the bearing on its parent in the tree with the joint turned round.

Two bodies float, the bearing on one and the journal on the other. Whichever of them the tree begins with,
they are the same two bodies, and so are their contacts, forces and motions.
"""

from __future__ import annotations

import base64
import dataclasses
import json
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.analysis import body_poses
from antenna_pin.base.records import POSE, words_of
from antenna_pin.contact import GonthierBristle, Hertz, KelvinVoigt, Tanh
from antenna_pin.dynamics import JointMotion, Workspace, audit
from antenna_pin.elements import JointSpring, PDController, SineDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import (
    PlanarClearance,
    PrismaticClearance,
    RevoluteClearance,
    SphericalClearance,
)
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.show.record import record

AXIS = np.array([1.0, 2.0, -2.0]) / 3.0
OFFSET = 0.017  # [m]
# Mass [kg], centre of mass [m] and inertia [kg m^2] of each body in the axes of the joint's frame on it.
BODIES = {
    "socket": (8.0, (0.1, -0.2, 0.05), (0.5, 0.6, 0.7, 0.01, -0.02, 0.03)),
    "pin": (3.0, (0.02, 0.1, 0.04), (0.04, 0.05, 0.03, 0.002, 0.001, -0.003)),
}
#: Of the joint's frame in whichever body is its parent.
ORIGIN = pin.SE3(pin.rpy.rpyToMatrix(0.5, -1.2, 2.0), np.array([0.2, 0.3, 0.4]))
SHAPES: dict[str, Any] = {
    "revolute": RevoluteClearance(
        bearing_radius=0.01,
        journal_radius=0.0098,
        bearing_length=0.05,
        flange_distance=0.0502,
        bearing_outer_radius=0.012,
        flange_radius=0.014,
    ),
    "planar": PlanarClearance(bearing_radius=0.01, journal_radius=0.0098),
    "spherical": SphericalClearance(socket_radius=0.02, ball_radius=0.0197),
    "prismatic": PrismaticClearance(
        guide_width=30.3e-3,
        guide_height=20.4e-3,
        slider_width=30e-3,
        slider_height=20e-3,
        slider_length=80e-3,
        corner_radius=0.5e-3,
        roll=0.2,
    ),
}
BRISTLES = GonthierBristle(
    static=0.3,
    dynamic=0.2,
    stribeck_speed=1e-3,
    bristle_stiffness=1e5,
    bristle_damping=50.0,
    dwell_time=1e-3,
)
POINT = {"friction": Tanh(coefficient_of_friction=0.2, transition_speed=1e-3), "backend": "closed-form"}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "revolute": ("revolute", POINT),
    "revolute, coal": ("revolute", POINT | {"backend": "coal"}),
    "revolute, distributed": ("revolute", POINT | {"load": "distributed"}),
    "revolute, bristles": ("revolute", POINT | {"friction": BRISTLES}),
    "planar": ("planar", POINT),
    "planar, coal": ("planar", POINT | {"backend": "coal"}),
    "spherical": ("spherical", POINT),
    "spherical, coal": ("spherical", POINT | {"backend": "coal"}),
    "prismatic": ("prismatic", POINT),
    "prismatic, coal": ("prismatic", POINT | {"backend": "coal"}),
}
cases = pytest.mark.parametrize("case", CASES)


class Floating(NamedTuple):
    """How the joint's frames on both bodies stand and move: of the socket, and of the pin in the socket."""

    socket: pin.SE3
    between: pin.SE3
    socket_twist: pin.Motion  # each in its own body's frame
    pin_twist: pin.Motion


def _link(name: str, origin: pin.SE3) -> str:
    mass, centre, inertia = BODIES[name]
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    moments = " ".join(f'{key}="{value}"' for key, value in zip(keys, inertia, strict=True))
    place = origin.act(np.array(centre))
    return (
        f'<link name="{name}"><inertial><origin xyz="{_text(place)}" '
        f'rpy="{_text(pin.rpy.matrixToRpy(origin.rotation))}"/><mass value="{mass}"/>'
        f"<inertia {moments}/></inertial></link>"
    )


def _text(vector: Any) -> str:
    return " ".join(f"{float(x)!r}" for x in vector)


def two_bodies(case: str, root: str, about: str = "bearing", loose: bool = False) -> System:
    """The two bodies in a tree that begins with ``root``; drives and a spring where there is an axis."""
    kind, given = CASES[case]
    first, second = ("socket", "pin") if root == "socket" else ("pin", "socket")
    limit = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
    urdf = Urdf.from_text(
        f'<robot name="two">{_link(first, ORIGIN)}{_link(second, pin.SE3.Identity())}'
        f'<joint name="j" type="{"prismatic" if kind == "prismatic" else "revolute"}">'
        f'<parent link="{first}"/><child link="{second}"/><axis xyz="{_text(AXIS)}"/>{limit}'
        f'<origin xyz="{_text(ORIGIN.translation)}" rpy="{_text(pin.rpy.matrixToRpy(ORIGIN.rotation))}"/>'
        "</joint></robot>",
        "two.urdf",
    ).variant(joints={"j": "planar" if kind == "planar" else "free"})
    law = KelvinVoigt(stiffness=2e7, damping=2e3) if given.get("load") else Hertz(stiffness=5e8)
    joint = ClearanceJoint(
        name="j",
        geometry=SHAPES[kind],
        radial=law,
        axial=law if kind == "revolute" else None,
        offset=0.0 if kind == "planar" else OFFSET,
        bearing_on="parent" if root == "socket" else "child",
        **given,
    )
    # The joint's angle or position is the child's against the parent.
    sign = 1.0 if root == "socket" else -1.0
    elements: dict[str, Any] = {}
    if kind != "spherical" and not loose:
        elements["drives"] = {
            "motor": SineDrive(joint="j", amplitude=2.0 * sign, frequency=3.0, phase=0.5, axis=about),
            "control": PDController(
                joint="j", kp=3.0, kd=0.02, angle=0.1 * sign, rate=-0.2 * sign, axis=about
            ),
        }
        elements["springs"] = {
            "coil": JointSpring(joint="j", stiffness=4.0, damping=0.05, rest_angle=0.4 * sign)
        }
    return System(build_mechanism(urdf, "free"), clearances=[joint], **elements)


def _plane(system: System) -> pin.SE3:
    """Placement of Pinocchio's joint frame in the URDF's: that of a planar joint has its axis along z."""
    planar = system.clearances[0].planar
    return pin.SE3(frame_aligning_z(AXIS) if planar else np.eye(3), np.zeros(3))


def configuration(system: System, bodies: Floating) -> tuple[np.ndarray, np.ndarray]:
    """The bodies' poses and twists as q and v of the system's tree."""
    base, twist = bodies.socket, bodies.socket_twist
    pose, relative = bodies.between, bodies.pin_twist - bodies.between.actInv(bodies.socket_twist)
    if system.clearances[0].bearing_on == "child":
        base, twist = bodies.socket * pose, bodies.pin_twist
        pose, relative = pose.inverse(), bodies.socket_twist - bodies.between.act(bodies.pin_twist)
    frame = _plane(system)
    pose, relative = frame.inverse() * pose * frame, frame.actInv(relative)
    q, v = system.neutral(), np.zeros(system.model.nv)
    q[:7] = pin.SE3ToXYZQUAT(base * ORIGIN.inverse())
    v[:6] = ORIGIN.act(twist).vector
    slot = system.mechanism.joint("j")
    if slot.kind == "planar":
        turn = np.array([pose.rotation[0, 0], pose.rotation[1, 0]])
        q[slot.q] = [*pose.translation[:2], *(turn / np.linalg.norm(turn))]
        v[slot.v] = relative.vector[[0, 1, 5]]
    else:
        q[slot.q], v[slot.v] = pin.SE3ToXYZQUAT(pose), relative.vector
    return q, v


def seen(system: System, q: Any, v: Any, a: Any) -> dict[str, tuple[pin.SE3, np.ndarray, np.ndarray]]:
    """Pose, twist and spatial acceleration of the joint's frame on each body."""
    data = system.model.createData()
    pin.forwardKinematics(system.model, data, q, v, a)
    base, child = 1, system.mechanism.joint("j").joint_id
    root, other = ("socket", "pin") if system.clearances[0].bearing_on == "parent" else ("pin", "socket")
    frame = _plane(system)
    return {
        root: (
            data.oMi[base] * ORIGIN,
            ORIGIN.actInv(data.v[base]).vector,
            ORIGIN.actInv(data.a[base]).vector,
        ),
        other: (
            data.oMi[child] * frame.inverse(),
            frame.act(data.v[child]).vector,
            frame.act(data.a[child]).vector,
        ),
    }


def thrown(case: str, rng: np.random.Generator, deep: float = 1.0, slow: float = 1.0) -> Floating:
    """Bodies somewhere, turning and drifting; the journal off centre by some plays, turned and tilted.

    Args:
        case: Which joint.
        rng: Where all that is random comes from.
        deep: How far the journal is off its centre, in plays.
        slow: Factor on its speed in the bearing, and on that of its tilt.
    """
    kind = CASES[case][0]
    shape = SHAPES[kind]
    play = shape.radial_clearance
    axes = frame_aligning_z(AXIS)
    shift = deep * play * np.array([*rng.uniform(-1.0, 1.0, 2), rng.uniform(-1.0, 1.0)])
    tilt = deep * rng.uniform(-0.3, 0.3, 2) * play / (shape.half_length or 0.01)
    angle = rng.uniform(-3.0, 3.0)
    if kind == "prismatic":
        shift[2], angle = rng.uniform(-0.2, 0.2), 0.5 * deep * play / 0.015 * rng.uniform(-1.0, 1.0)
    velocity, spin = 0.05 * slow * rng.normal(size=3), rng.normal(size=3) * [slow, slow, 1.0]
    if kind == "prismatic":
        spin[2] *= slow
    if kind == "planar":
        shift[2], tilt[:], velocity[2], spin[:2] = 0.0, 0.0, 0.0, 0.0
    turn = axes @ pin.exp3(np.array([*tilt, 0.0])) @ pin.exp3(np.array([0.0, 0.0, angle])) @ axes.T
    centre = OFFSET * AXIS
    between = pin.SE3(turn, axes @ shift + centre - turn @ centre)
    relative = pin.Motion(np.array([*(axes @ velocity), *(axes @ spin)]))
    socket = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    twist = pin.Motion(0.3 * rng.normal(size=6))
    return Floating(socket, between, twist, between.actInv(twist) + relative)


@cases
@pytest.mark.parametrize("about", ["bearing", "journal"])
def test_both_trees_have_the_same_contacts_and_accelerations(case, about):
    """In states of all kinds, in contact and apart, tilted, off centre and turned.

    Round-off of 1e-17 m in gaps of 1e-4 m, and of a few 1e-15 in the dynamics of either tree: 1e-10 of what
    is largest leaves a factor of 100.
    """
    one, other = (two_bodies(case, root, about) for root in ("socket", "pin"))
    rng, touched = np.random.default_rng(5), 0
    for t in rng.uniform(0.0, 1.0, 12):
        bodies, found = thrown(case, rng, deep=1.5), []
        for system in (one, other):
            y = system.state(*configuration(system, bodies))
            y[system.model.nq + system.model.nv + system.bristle_x] = 1e-6
            workspace = Workspace(system)
            memory = workspace.first_memory(y)
            workspace.memory[:] = memory
            rates = np.zeros(system.model.nv + system.manifold.nx)
            workspace.derivative(t, y, rates)
            workspace.measure(y)
            nq, nv = system.model.nq, system.model.nv
            motion = seen(system, y[:nq], y[nq : nq + nv], rates[:nv])
            pose = np.zeros(1, POSE)
            place_journal(system.program, system.clearance_blocks["j"], y, nq, pose)
            found.append((workspace.table.copy(), memory, rates[nv:].copy(), motion, pose))
        (table, memory, rates, bodies_one, pose), others = found
        table_other, memory_other, rates_other, bodies_other, pose_other = others
        for name in ("centre", "axis", "sine", "rotation", "velocity", "spin"):
            assert pose_other[name] == pytest.approx(pose[name], abs=1e-14)
        touched += np.count_nonzero(memory["touching"])
        for name in ("touching", "approach_speed", "effective_mass"):
            assert memory_other[name] == pytest.approx(
                memory[name], rel=1e-9
            )  # of closing speeds of 1e-2 m/s
        contacts = len(one.contact_names)
        for name in ("gap", "normal", "point", "rate", "slip"):
            assert table_other[name][:contacts] == pytest.approx(table[name][:contacts], rel=1e-10, abs=1e-14)
        largest = max(1.0, np.abs(table["force"]).max())
        for name in ("force", "friction"):
            assert table_other[name] == pytest.approx(table[name], abs=1e-10 * largest)
        assert rates_other == pytest.approx(rates, rel=1e-9, abs=1e-10 * largest)
        for name, (pose, twist, acceleration) in bodies_one.items():
            assert bodies_other[name][0].isApprox(pose, 1e-14)
            assert bodies_other[name][1] == pytest.approx(twist, abs=1e-13)
            scale = np.abs(acceleration).max()
            assert bodies_other[name][2] == pytest.approx(acceleration, abs=1e-10 * max(scale, 1.0))
    assert touched > 5


@cases
def test_the_generalized_force_has_the_power_of_the_wrench_on_the_journal(case):
    """tau . v = F . velocity + M . spin, the journal's motion being that which the bearing sees."""
    rng = np.random.default_rng(6)
    for root in ("socket", "pin"):
        system = two_bodies(case, root, loose=True)
        nq, nv = system.model.nq, system.model.nv
        for _ in range(10):
            q, v = configuration(system, thrown(case, rng, deep=1.5))
            y = system.state(q, v)
            workspace = Workspace(system)
            workspace.memory[:] = workspace.first_memory(y)
            rates = np.zeros(nv + system.manifold.nx)
            workspace.apply_elements(0.0, y, rates)
            pose = workspace.work[nv : nv + words_of(POSE)].view(POSE)[0]
            power = pose.force @ pose.velocity + pose.moment @ pose.spin
            size = np.abs(pose.force * pose.velocity).sum() + np.abs(pose.moment * pose.spin).sum()
            # Round-off.
            assert workspace.tau @ v == pytest.approx(power, rel=0.0, abs=1e-13 * max(size, 1.0))
            assert size > 0.0 or not workspace.memory["touching"].any()
            assert nq == len(q)


SETTINGS = RunSettings(rtol=1e-11, output_rate=500.0)
#: The ball, which has more play, is thrown harder.
RUNS = {"revolute, coal": 0.2, "revolute, bristles": 0.2, "planar": 0.2, "spherical": 0.7, "prismatic": 0.2}


@pytest.mark.parametrize(("case", "slow"), RUNS.items())
def test_both_trees_run_alike_over_impacts(case, slow):
    """World motion of both bodies, contacts, drives and energies, over impacts with friction.

    At rtol = 1e-11 a run is good to some 1e-10 of its scales; an impact passes an error in speed on about
    tenfold at these plays. 1e-6 of the plays and of the largest force and energy leaves a factor of ten.
    """
    bodies = thrown(case, np.random.default_rng(8), deep=0.3, slow=slow)
    runs, systems = [], []
    for root in ("socket", "pin"):
        system = two_bodies(case, root)
        q, v = configuration(system, bodies)
        runs.append(simulate(system, duration=0.04, q=q, v=v, settings=SETTINGS))
        systems.append(system)
    one, other = (run.data for run in runs)
    assert one.sizes["episode"] == other.sizes["episode"] >= 3
    play = SHAPES[CASES[case][0]].radial_clearance
    assert other["onset_time"].values == pytest.approx(one["onset_time"].values, abs=1e-8)  # at some 0.01 m/s
    assert (other["episode_contact"].values == one["episode_contact"].values).all()
    for name in ("peak_force", "effective_mass", "approach_speed"):
        assert other[name].values == pytest.approx(one[name].values, rel=1e-5)
    times = np.arange(0.0, 0.0401, 0.002)
    one, other = (data.sel(time=times, method="nearest") for data in (one, other))
    assert one["time"].values == pytest.approx(times, abs=1e-12)
    for name in ("journal_position", "gap"):
        assert other[name].values == pytest.approx(one[name].values, abs=1e-6 * play)
    for name in ("journal_attitude", "journal_tilt"):
        assert other[name].values == pytest.approx(one[name].values, abs=1e-8)
    force = max(float(runs[0].data["peak_force"].max()), 1.0)
    for name in ("joint_force", "contact_force", "normal_force"):
        assert other[name].values == pytest.approx(one[name].values, abs=1e-5 * force)
    energy = float(one["kinetic_energy"].max())
    for name in (
        *("kinetic_energy", "contact_energy", "spring_energy", "drive_work", "dissipation_normal"),
        *("dissipation_friction", "normal_impulse", "linear_momentum", "angular_momentum"),
    ):
        if name in one:
            assert other[name].values == pytest.approx(one[name].values, abs=1e-7 * energy)
    for name in ("motion_angle", "motion_rate", "slide_position", "slide_rate", "drive_torque"):
        if name in one and one[name].size:
            assert other[name].values == pytest.approx(-one[name].values, abs=1e-6)
    for name in ("motion_acceleration", "slide_acceleration"):
        if name in one and one[name].size:
            scale = np.abs(one[name].values).max()
            assert other[name].values == pytest.approx(-one[name].values, abs=1e-5 * scale)
    for run, system in zip(runs, systems, strict=True):
        kept = json.loads(run.data.attrs["conservation"])
        assert kept["energy_error"] < 1e-8 * energy  # rtol, and some thousand steps
        assert kept["linear_momentum_drift_relative"] < 1e-10
        assert kept["angular_momentum_drift_relative"] < 1e-10
        assert system.clearances[0].bearing_on == ("parent" if system is systems[0] else "child")
    _same_places(runs, times, play)
    if "motion_angle" in runs[0].data:
        _drawn_spin(runs)


def _drawn_spin(runs: Any) -> None:
    """A joint's picture turns the journal as it turns in its bearing; to single precision."""
    for run in runs:
        picture = record(run, view="joint")
        attitude = run.data["journal_attitude"].values[picture.frames.indices, 0]
        for track in picture.data["actors"][0]["tracks"]:
            if not track["name"].endswith("spin"):
                continue
            drawn = np.frombuffer(base64.b64decode(track["data"]), "<f4").reshape(-1, 7)[:, 3:]
            twist = attitude * [0.0, 0.0, 1.0, 1.0]
            twist /= np.linalg.norm(twist, axis=1)[:, None]
            assert np.abs(np.sum(drawn * twist, axis=1)) == pytest.approx(1.0, abs=1e-6)


def _same_places(runs: Any, times: Any, play: float) -> None:
    """Bearing and journal stand in the world where the carried placements say, in either tree."""
    found = []
    for run in runs:
        place = json.loads(run.data.attrs["clearance_joints"])["j"]
        assert (place["bearing_body"], place["journal_body"]) == ("socket", "pin")
        poses, frames = body_poses(run), []
        for part in ("bearing", "journal"):
            link = poses.sel(body=place[f"{part}_body"])
            turn, own = Rotation.from_quat(link["attitude"].values), np.array(place[f"{part}_placement"])
            frames.append((link["position"].values + turn.apply(own[:3]), turn * Rotation.from_quat(own[3:])))
        (bearing, turn), (journal, turned) = frames
        # Round-off of positions of 1 m.
        position = run.data["journal_position"].values[:, 0]
        assert turn.inv().apply(journal - bearing) == pytest.approx(position, abs=1e-14)
        attitude = Rotation.from_quat(run.data["journal_attitude"].values[:, 0])
        assert (turn * attitude * turned.inv()).magnitude().max() < 1e-14
        nearest = [int(np.abs(run.data["time"].values - t).argmin()) for t in times]
        found.append((bearing[nearest], journal[nearest]))
    for a, b in zip(*found, strict=True):
        assert b == pytest.approx(a, abs=1e-5 * play)


@pytest.mark.parametrize("kind", ["revolute", "planar", "prismatic"])
def test_the_joint_angle_is_the_childs_against_the_parent(kind):
    """That of the ideal joint, whichever part has the bore; so is a position."""
    for root in ("socket", "pin"):
        system = two_bodies(kind, root)
        slot, q = system.mechanism.joint("j"), system.neutral()
        if kind == "prismatic":
            q[slot.q][:3] = 0.05 * AXIS
        elif kind == "planar":
            q[slot.q] = [0.0, 0.0, np.cos(0.7), np.sin(0.7)]
        else:
            q[slot.q] = [0.0, 0.0, 0.0, *(np.sin(0.35) * AXIS), np.cos(0.35)]
        v = np.zeros(system.model.nv)
        v[slot.v] = {"prismatic": [*(0.3 * AXIS), 0, 0, 0], "planar": [0, 0, 0.3]}.get(
            kind, [0, 0, 0, *(0.3 * AXIS)]
        )
        wanted = 0.05 if kind == "prismatic" else 0.7
        # Round-off.
        assert JointMotion(system, "j")(system.state(q, v)) == pytest.approx((wanted, 0.3), rel=1e-14)


def test_the_ledger_counts_what_drives_put_in_at_a_tilted_joint():
    """Power of drive and spring over either axis is tau . v, wherever the bearing is."""
    rng = np.random.default_rng(9)
    for kind in ("revolute", "prismatic"):
        for about in ("bearing", "journal"):
            system = two_bodies(kind, "pin", about)
            y = system.state(*configuration(system, thrown(kind, rng, deep=3.0)))
            workspace = Workspace(system)
            rates = np.zeros(system.model.nv + system.manifold.nx)
            workspace.apply_elements(0.3, y, rates)
            v = y[system.model.nq : system.model.nq + system.model.nv]
            still = audit(workspace, y).springs
            h = 1e-6
            later, before = (
                audit(
                    workspace, system.state(pin.integrate(system.model, y[: system.model.nq], s * h * v), v)
                )
                for s in (1.0, -1.0)
            )
            stored = (later.springs - before.springs) / (2.0 * h)
            x = rates[system.model.nv :]
            balance = x[system.work_x].sum() - x[system.damper_x].sum() - stored
            # Truncation h^2 times a third derivative of some 100 J/s^3; round-off 1e-15 J / h.
            assert workspace.tau @ v == pytest.approx(balance, abs=1e-8)
            assert still > 0.0


def test_refuses_another_place():
    with pytest.raises(InvalidParameterError, match="bearing_on must be parent or child, got 'world'"):
        dataclasses.replace(two_bodies("planar", "socket").clearances[0], bearing_on="world")  # type: ignore[arg-type]
