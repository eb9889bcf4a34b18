"""A floating hull with a limb by each kind of joint, and random states of it."""

import pinocchio as pin

# A floating hull with a limb by each kind of joint, and a branch on a branch.
LIMBS = {
    "turn": ("revolute", "hull", "arm", "1 2 -2"),
    "wheel": ("continuous", "arm", "disc", "-0.3 0.1 -0.9"),
    "slide": ("prismatic", "hull", "weight", "0 1 1"),
    "loose": ("floating", "weight", "ball", "0 0 1"),
    "flat": ("planar", "hull", "puck", "0 0 1"),
}
BODIES = ("hull", *(child for _, _, child, _ in LIMBS.values()))


def robot():
    links = "".join(
        f'<link name="{name}"><inertial><origin xyz="0.1 {0.1 * k} -0.05"/><mass value="{1 + k}"/>'
        '<inertia ixx="0.2" iyy="0.25" izz="0.21" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link>'
        for k, name in enumerate(BODIES)
    )
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.2 {0.3 * k} -0.4" rpy="{0.5 * k} -1.2 0.3"/><axis xyz="{axis}"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        for k, (name, (kind, parent, child, axis)) in enumerate(LIMBS.items())
    )
    # A tip that a fixed joint makes part of the disc.
    tip = (
        '<link name="tip"/><joint name="tip_mount" type="fixed"><parent link="disc"/><child link="tip"/>'
        '<origin xyz="0.1 0.2 0.3" rpy="0.4 0 1"/></joint>'
    )
    return f'<robot name="robot">{links}{joints}{tip}</robot>'


def random_state(system, rng):
    q = pin.integrate(system.model, system.neutral(), rng.normal(size=system.model.nv))
    return system.state(q, rng.normal(size=system.model.nv))


def parts(system, y):
    nq, nv = system.model.nq, system.model.nv
    return y[:nq], y[nq : nq + nv]
