"""A tree that is nowhere symmetric, and loops of every kind that are closed on it."""

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from antenna_pin.dynamics import System, assembled
from antenna_pin.dynamics.constraints import CLOSURES, Anchor, Closure
from antenna_pin.mechanism import Urdf, build_mechanism

LINK = """<link name="{name}"><inertial><origin xyz="{x} 0.05 -0.02"/><mass value="{m}"/>
  <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
  <origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>"""
BRANCHES = (
    ("j1", "revolute", "hull", "a1", "0.2 0.1 0", "0.3 0.2 0.1", "1 2 -1"),
    ("j2", "continuous", "a1", "a2", "0.3 0 0.1", "-0.5 0.4 0.9", "0 1 0"),
    ("j3", "revolute", "a2", "a3", "0.25 0 0", "1.5 0.1 -0.7", "0.3 0 1"),
    ("j4", "floating", "hull", "b1", "-0.2 0.15 0.3", "0 0.7 0", "0 0 1"),
    ("j5", "prismatic", "b1", "b2", "0.1 0 0.4", "0.2 -0.3 1.1", "1 1 0"),
    ("j6", "revolute", "b2", "b3", "0.3 0.1 0", "0 0.2 0.5", "0 -1 0.2"),
)
NAMES = ("name", "kind", "parent", "child", "xyz", "rpy", "axis")
TREE = "\n".join(
    [
        '<robot name="branches">',
        LINK.format(name="hull", x=0.0, m=20),
        *(LINK.format(name=row[3], x=0.1, m=1.0 + 0.3 * i) for i, row in enumerate(BRANCHES)),
        *(JOINT.format(**dict(zip(NAMES, row, strict=True))) for row in BRANCHES),
        "</robot>",
    ]
)


def freedom(kind, random):
    """A displacement and a turn that a closure leaves free, of its second side in the first."""
    shift, turn = random.normal(scale=0.2, size=3), random.uniform(-2.5, 2.5)
    about_z = Rotation.from_rotvec([0.0, 0.0, turn])
    if kind == "universal":  # the second axis across the first, turned about both
        return np.zeros(3), about_z * Rotation.from_euler("xz", [np.pi / 2.0, random.uniform(-2.0, 2.0)])
    held = CLOSURES[kind]
    shift[["xyz".index(axis) for axis in held.along]] = 0.0
    if not held.about:
        return shift, Rotation.random(random_state=7)
    return shift, about_z if "z" not in held.about else Rotation.identity()


def closed(kind, seed, *, base="free", count=1, to="b3", **elements):
    """A system whose closure is closed at a random configuration, and a state that moves."""
    random = np.random.default_rng(seed)
    mechanism = build_mechanism(Urdf.from_text(TREE, "branches.urdf"), base, (0.0, 0.0, -9.8))
    model, data = mechanism.model, mechanism.model.createData()
    q = pin.integrate(model, pin.neutral(model), random.normal(scale=0.6, size=model.nv))
    pin.framesForwardKinematics(model, data, q)
    first = pin.SE3(Rotation.random(random_state=seed).as_matrix(), random.normal(scale=0.1, size=3))
    shift, turn = freedom(kind, random)
    place = data.oMf[mechanism.frame("a3")] * first * pin.SE3(turn.as_matrix(), shift)
    second = place if to == "world" else data.oMf[mechanism.frame(to)].inverse() * place
    sides = [
        Anchor(link=link, rotation=frame.rotation.copy(), origin=frame.translation.copy())
        for link, frame in (("a3", first), (to, second))
    ]
    names = [f"loop{k}" for k in range(count)]
    closures = {name: Closure(kind=kind, first=sides[0], second=sides[1]) for name in names}
    system = System(mechanism, closures=closures, **elements)
    q, v = assembled(system, q, random.normal(size=model.nv))
    return system, system.state(q, v)
