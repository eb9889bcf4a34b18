"""Random trees of one-axis joints of which some follow others, and the same systems in fewer coordinates."""

import numpy as np
import pinocchio as pin

from antenna_pin import Coupling, System, Urdf, build_mechanism

KINDS = ("revolute", "continuous", "prismatic")


def tree_text(rng, joints, mimics=None, kinds=KINDS, chain=False):
    """A URDF of a random tree, or chain; ``mimics``: leader, multiplier and offset of joints, by number."""

    def three(size):
        return " ".join(repr(float(x)) for x in rng.uniform(-size, size, 3))

    def link(name, mass):
        a, b, c = (rng.uniform(0.5, 1.0, 3) * mass * 0.05).tolist()
        inertia = f'ixx="{b + c!r}" iyy="{a + c!r}" izz="{a + b!r}" ixy="0" ixz="0" iyz="0"'
        return (
            f'<link name="{name}"><inertial><origin xyz="{three(0.3)}" rpy="{three(1)}"/>'
            f'<mass value="{mass!r}"/><inertia {inertia}/></inertial></link>'
        )

    text = link("l0", 8.0)
    for k in range(1, joints + 1):
        mimic = ""
        if mimics and k in mimics:
            leader, multiplier, offset = mimics[k]
            mimic = f'<mimic joint="j{leader}" multiplier="{multiplier!r}" offset="{offset!r}"/>'
        text += (
            f'<joint name="j{k}" type="{rng.choice(kinds)}">'
            f'<parent link="l{k - 1 if chain else rng.integers(k)}"/>'
            f'<child link="l{k}"/><origin xyz="{three(0.5)}" rpy="{three(2)}"/><axis xyz="{three(1)}"/>'
            f'<limit lower="-9" upper="9" effort="1" velocity="1"/>{mimic}</joint>'
            + link(f"l{k}", float(rng.uniform(0.5, 3.0)))
        )
    return f'<robot name="tree">{text}</robot>'


class Coupled:
    """A random system with couplings, some from the URDF, some beside it, chains among them.

    Attributes:
        system: It.
        text: Its URDF.
        followers: Leader, multiplier and offset by number of the joint.
    """

    def __init__(self, seed, base="free", gravity=(0.4, -0.3, -9.0), joints=6, followers=3, **elements):
        """Draw it."""
        rng = np.random.default_rng(seed)
        chosen = [int(k) for k in rng.permutation(joints)[:followers] + 1]
        # No circles: a joint follows one that is nobody's follower, or comes later among the followers.
        self.followers = {}
        for n, k in enumerate(chosen):
            free = [j for j in range(1, joints + 1) if j not in chosen[: n + 1]]
            self.followers[k] = (int(rng.choice(free)), float(rng.uniform(-3, 3)), float(rng.uniform(-1, 1)))
        in_urdf = dict(list(self.followers.items())[: followers - 1])
        self.text = tree_text(np.random.default_rng(seed + 1), joints, in_urdf)
        beside = {
            f"c{k}": Coupling(follower=f"j{k}", leader=f"j{leader}", multiplier=m, offset=o)
            for k, (leader, m, o) in self.followers.items()
            if k not in in_urdf
        }
        mechanism = build_mechanism(Urdf.from_text(self.text, "tree.urdf"), base, gravity)
        self.system = System(mechanism, couplings=beside, **elements)

    @property
    def directions(self):
        """G of v = G w, w the velocities of what follows nothing, (nv, k)."""
        nv = self.system.model.nv
        slots = {
            k: self.system.mechanism.joint(f"j{k}").v.start for k in range(1, nv + 1) if f"j{k}" in self.names
        }
        g, followers = np.eye(nv), dict(self.followers)
        while followers:
            k = next(k for k in followers if followers[k][0] not in followers)
            leader, multiplier, _ = followers.pop(k)
            g[slots[k]] = multiplier * g[slots[leader]]
        keep = [i for i in range(nv) if i not in {slots[k] for k in self.followers}]
        return g[:, keep]

    @property
    def names(self):
        """Of the joints."""
        return self.system.mechanism.joints

    def random_state(self, rng):
        """Return y = [q, v, x] on the couplings: angles up to 2 rad, and their followers'."""
        system, model = self.system, self.system.model
        place = {f"j{k}": float(rng.uniform(-2, 2)) for k in range(1, len(self.names) + 1)}
        followers = dict(self.followers)
        while followers:
            k = next(k for k in followers if followers[k][0] not in followers)
            leader, multiplier, offset = followers.pop(k)
            place[f"j{k}"] = multiplier * place[f"j{leader}"] + offset
        q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
        if system.mechanism.base == "free":
            q[:7] = [*rng.normal(size=3), *pin.Quaternion(pin.exp3(rng.normal(size=3))).coeffs()]
        for name, angle in place.items():
            slot = system.mechanism.joint(name)
            q[slot.q] = (np.cos(angle), np.sin(angle)) if slot.kind == "continuous" else angle
        g = self.directions
        v = g @ rng.normal(size=g.shape[1])
        return system.state(q, v, {name: place[name] for name in system.turn_x})
