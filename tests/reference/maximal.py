r"""Rigid bodies in maximal coordinates with multipliers: a second formulation to compare the package with.

Every body has its six coordinates: the mass centre r in the world, a quaternion (x, y, z, w) from body to
world, the velocity of the mass centre and the angular velocity w, both in world axes. A joint is a handful of
rows C(q, t) = 0, each of one of two kinds:

- *along*: n . d = f(t), with n fixed in the first body and d from the first side's point to the second's;
- *across*: a . b = 0, with a in the first body, turned about its z by f(t), and b fixed in the second.

Accelerations are those of Gauss' principle, M a = Q + J' l with J a = -gamma, solved in mass-weighted
coordinates by least squares of minimum norm, so that redundant rows do no harm. Positions and velocities are
projected back at each output, by Newton in the metric of the mass matrix. NumPy and SciPy only; nothing here
knows the package. SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from maximal_history import History
from maximal_parts import ROWS, WORLD, Body, Joint, Motion, Side, Spring
from maximal_vectors import cross, dot, matrices, turned
from scipy.integrate import DOP853
from scipy.linalg import lstsq, sqrtm
from scipy.spatial.transform import Rotation

_RANK = 1e-8
"""Singular values below this share of the largest are zero; what tests use has none from 1e-5 to 1e-14."""


class Maximal:
    """Bodies, joints between them, what drives and what springs them.

    Args:
        bodies: By name.
        joints: By name.
        motions: Prescribed motions of revolute and prismatic joints, at most one a joint.
        springs: Between points.
        gravity: [m/s^2].
    """

    def __init__(
        self,
        bodies: Mapping[str, Body],
        joints: Mapping[str, Joint],
        motions: Sequence[Motion] = (),
        springs: Sequence[Spring] = (),
        gravity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        self.bodies, self.joints, self.motions = dict(bodies), dict(joints), tuple(motions)
        self.springs, self.gravity = tuple(springs), np.array(gravity, dtype=float)
        self._index = {name: k for k, name in enumerate([*self.bodies, WORLD])}
        self.mass = np.array([body.mass for body in self.bodies.values()])
        self.inertia = np.array([body.moments for body in self.bodies.values()])
        self.weight = np.array([np.linalg.inv(sqrtm(i).real) for i in self.inertia])  # I^-1/2, in body axes
        names, motion = list(self.joints), {m.joint: k for k, m in enumerate(self.motions)}
        along: list[tuple] = []  # joint, first body, second body, motion, points, directions
        across: list[tuple] = []
        for name, joint in self.joints.items():
            A, B = joint.first, joint.second
            a, b = (dict(zip("xyz", side.frame.T, strict=True)) for side in (A, B))
            ends = (names.index(name), self._index[A.body], self._index[B.body])
            points = (self._arm(A), self._arm(B))
            directions, pairs = ROWS[joint.kind]
            along += [(*ends, -1, *points, a[n]) for n in directions]
            across += [(*ends, -1, a[p[0]], a["z"], b[p[1]]) for p in pairs]
            if name in motion and joint.kind == "prismatic":
                along.append((*ends, motion[name], *points, a["z"]))
            elif name in motion:  # revolute
                across.append((*ends, motion[name], a["y"], a["z"], b["x"]))
        self._along = [np.array(c) for c in zip(*along, strict=True)]
        self._across = [np.array(c) for c in zip(*across, strict=True)] or [
            *np.zeros((4, 0), int), *np.zeros((3, 0, 3))
        ]  # fmt: skip
        self._joint = np.concatenate([self._along[0], self._across[0]])
        self._motion = np.concatenate([self._along[3], self._across[3]])
        self.rows = len(self._joint)

    def index(self, body: str) -> int:
        """Return a body's place in arrays."""
        return self._index[body]

    def with_motions(self, motions: Sequence[Motion]) -> Maximal:
        """Return the same bodies and joints, driven otherwise."""
        return Maximal(self.bodies, self.joints, motions, self.springs, self.gravity)

    # --- rows ---

    def constraints(self, t: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return C (m,), J (m, n, 6), the explicit rate of C and gamma, what C'' is without accelerations."""
        r, R, v, w = self._unpacked(y)
        f, df, ddf = self._values(t)
        J = np.zeros((self.rows, len(self.bodies) + 1, 6))
        k = np.arange(self.rows)
        # along: C = n . d - f
        _, A, B, of, s_A, s_B, n = self._along
        n, s_A, s_B = turned(R[A], n), turned(R[A], s_A), turned(R[B], s_B)
        w_A, w_B = w[A], w[B]
        u_A, u_B, dn = cross(w_A, s_A), cross(w_B, s_B), cross(w_A, n)
        d, dd = r[B] + s_B - r[A] - s_A, v[B] + u_B - v[A] - u_A
        C_1, rate_1 = dot(n, d) - f[of], -df[of]
        gamma_1 = (
            dot(n, cross(w_B, u_B) - cross(w_A, u_A)) + 2.0 * dot(dn, dd) + dot(cross(w_A, dn), d) - ddf[of]
        )
        J[k[: len(A)], A] = np.concatenate([-n, cross(n, s_A + d)], axis=1)
        J[k[: len(A)], B] += np.concatenate([n, cross(s_B, n)], axis=1)
        # across: C = a . b, a turned by f about z
        k = k[len(A) :]
        _, A, B, of, a, z, b = self._across
        c, s, df, ddf = np.cos(f[of])[:, None], np.sin(f[of])[:, None], df[of][:, None], ddf[of][:, None]
        a, z, b = turned(R[A], c * a + s * cross(z, a)), turned(R[A], z), turned(R[B], b)
        w_A, w_B = w[A], w[B]
        z_a, w_a, w_b, a_b = cross(z, a), cross(w_A, a), cross(w_B, b), cross(a, b)
        dda = cross(w_A, w_a + 2.0 * df * z_a) + ddf * z_a - df**2 * a
        gamma_2 = dot(dda, b) + 2.0 * dot(w_a + df * z_a, w_b) + dot(a, cross(w_B, w_b))
        J[k, A, 3:], J[k, B, 3:] = a_b, -a_b
        return (
            np.concatenate([C_1, dot(a, b)]),
            J[:, :-1],
            np.concatenate([rate_1, df[:, 0] * dot(z_a, b)]),
            np.concatenate([gamma_1, gamma_2]),
        )

    def load_map(self, joint: str, t: float, y: np.ndarray) -> np.ndarray:
        """Return what takes multipliers to the load of a joint, (6, m), see :meth:`History.load`."""
        J = self.constraints(t, y)[1]
        rows = (self._joint == list(self.joints).index(joint)) & (self._motion < 0)
        first, second = self.joints[joint].first, self.joints[joint].second
        _, R, _, _ = self._unpacked(y)
        A, B = self._index[first.body], self._index[second.body]
        axes = R[A] @ first.frame
        # What acts on a body is what acts on the other, turned round: take the one that is not the world.
        if second.body != WORLD:
            force, moment = J[:, B, :3], J[:, B, 3:] - np.cross(R[B] @ self._arm(second), J[:, B, :3])
        else:
            arm = np.array(second.point) - y[A, :3]
            force, moment = -J[:, A, :3], -(J[:, A, 3:] - np.cross(arm, J[:, A, :3]))
        return np.concatenate([axes.T @ (force * rows[:, None]).T, axes.T @ (moment * rows[:, None]).T])

    def ambiguous(self, joint: str, t: float, y: np.ndarray) -> np.ndarray:
        """Return the loads (6, redundant rows) of a joint that redundant rows may add to it."""
        left, values, _ = np.linalg.svd(self._weighted(self.constraints(t, y)[1], y))
        return self.load_map(joint, t, y) @ left[:, int((values > _RANK * values[0]).sum()) :]

    def driven_row(self, joint: str) -> int:
        """Return the row of a joint's motion."""
        return int(np.flatnonzero((self._joint == list(self.joints).index(joint)) & (self._motion >= 0))[0])

    # --- dynamics ---

    def acceleration(self, t: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return accelerations (n, 6) and what the rows had to change of them, mass-weighted, (6 n,)."""
        _, J, _, gamma = self.constraints(t, y)
        free = self._free(y)
        change = _least(self._weighted(J, y), -gamma - np.einsum("mni,ni->m", J, free))
        return free + self._unweighted(change, y), change

    def multipliers(self, t: float, y: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return the multipliers (m,), of minimum norm where rows are redundant [N, N m]."""
        return _least(self._weighted(self.constraints(t, y)[1], y).T, change)

    def energy(self, y: np.ndarray) -> float:
        """Return kinetic plus potential energy [J]."""
        r, R, v, w = (x[:-1] for x in self._unpacked(y))
        spin = turned(R.transpose(0, 2, 1), w)
        kinetic = (self.mass * dot(v, v)).sum() + dot(spin, turned(self.inertia, spin)).sum()
        springs = sum(s.stiffness * (self._stretch(s, y)[0] - s.length) ** 2 for s in self.springs)
        return float(0.5 * (kinetic + springs) - self.mass @ r @ self.gravity)

    # --- states ---

    @cached_property
    def start(self) -> np.ndarray:
        """The state (n, 13) that the bodies are given in, at rest."""
        y = np.zeros((len(self.bodies), 13))
        for k, body in enumerate(self.bodies.values()):
            attitude = np.array(body.attitude, dtype=float)
            y[k, :3] = np.array(body.position) + attitude @ np.array(body.centre)
            y[k, 3:7] = Rotation.from_matrix(attitude).as_quat()
        return y

    def projected(self, t: float, y: np.ndarray) -> np.ndarray:
        """Return the nearest state, in the metric of the masses, that obeys all rows, as far as round-off."""
        y, last = y.copy(), np.inf
        for _ in range(30):
            y[:, 3:7] /= np.linalg.norm(y[:, 3:7], axis=1, keepdims=True)
            C, J, rate, _ = self.constraints(t, y)
            W, worst = self._weighted(J, y), np.abs(C).max()
            if worst < 1e-15 or worst > 0.5 * last and worst < 1e-12:
                break
            step, last = self._unweighted(_least(W, -C), y), worst
            y[:, :3] += step[:, :3]
            y[:, 3:7] = (Rotation.from_rotvec(step[:, 3:]) * Rotation.from_quat(y[:, 3:7])).as_quat()
        else:
            raise ArithmeticError(f"rows not met: {worst:g}")
        step = self._unweighted(_least(W, -rate - np.einsum("mni,ni->m", J, y[:, 7:])), y)
        y[:, 7:] += step
        return y

    def run(
        self, times: Sequence[float], y: np.ndarray | None = None, rtol: float = 1e-12, atol: float = 1e-13
    ) -> History:
        """Integrate by DOP853 from the first of the times and a state near one that obeys the rows."""
        n = len(self.bodies)

        def rates(t: float, flat: np.ndarray) -> np.ndarray:
            y = flat.reshape(n, 13)
            dy = np.empty_like(y)
            dy[:, :3], dy[:, 7:] = y[:, 7:10], self.acceleration(t, y)[0]
            q, w = y[:, 3:7], y[:, 10:]
            dy[:, 3:6] = 0.5 * (q[:, 3:] * w + cross(w, q[:, :3]))
            dy[:, 6] = -0.5 * dot(w, q[:, :3])
            return dy.ravel()

        y, step = self.projected(times[0], self.start if y is None else y), 1e-3
        states = [y]
        for t, end in zip(times[:-1], times[1:], strict=True):
            first = min(step, end - t)
            solver = DOP853(rates, t, y.ravel(), end, rtol=rtol, atol=atol, first_step=first)
            while solver.status == "running":
                solver.step()
                step = max(step, solver.step_size) if solver.status == "finished" else solver.step_size
            if solver.status != "finished":
                raise ArithmeticError("no step is short enough")
            y = self.projected(end, solver.y.reshape(n, 13))
            states.append(y)
        found = [(t, y, *self.acceleration(t, y)) for t, y in zip(times, states, strict=True)]
        return History(
            self,
            np.array(times, dtype=float),
            np.array(states),
            np.array([a for _, _, a, _ in found]),
            np.array([self.multipliers(t, y, change) for t, y, _, change in found]),
        )

    # --- parts ---

    def _arm(self, side: Side) -> np.ndarray:
        """Return a side's point from its body's mass centre, in the body's axes."""
        centre = (0.0, 0.0, 0.0) if side.body == WORLD else self.bodies[side.body].centre
        return np.array(side.point, dtype=float) - centre

    def _unpacked(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return r, R, v, w of all bodies and, last, of the world."""
        y = np.vstack([y, [0.0] * 6 + [1.0] + [0.0] * 6])
        return y[:, :3], matrices(y[:, 3:7]), y[:, 7:10], y[:, 10:]

    def _values(self, t: float) -> np.ndarray:
        """Return position, velocity and acceleration of all motions, and zeros for rows that have none."""
        return np.array(
            [(m.position(t), m.velocity(t), m.acceleration(t)) for m in self.motions] + [(0.0, 0.0, 0.0)]
        ).T

    def _free(self, y: np.ndarray) -> np.ndarray:
        """Return the accelerations (n, 6) of the bodies without their joints."""
        _, R, _, w = (x[:-1] for x in self._unpacked(y))
        forces = np.zeros((len(self.bodies) + 1, 6))
        forces[:-1, :3] = self.mass[:, None] * self.gravity
        for spring in self.springs:
            length, rate, direction, arms = self._stretch(spring, y)
            pull = (spring.stiffness * (length - spring.length) + spring.damping * rate) * direction
            for side, arm, force in zip((spring.first, spring.second), arms, (pull, -pull), strict=True):
                forces[self._index[side.body]] += [*force, *np.cross(arm, force)]
        back = R.transpose(0, 2, 1)
        spin = turned(back, w)
        moment = turned(back, forces[:-1, 3:]) - cross(spin, turned(self.inertia, spin))
        return np.concatenate(
            [forces[:-1, :3] / self.mass[:, None], turned(R, turned(self.weight @ self.weight, moment))],
            axis=1,
        )

    def _stretch(self, spring: Spring, y: np.ndarray) -> tuple[float, float, np.ndarray, list[np.ndarray]]:
        """Return a spring's length, its rate, its direction from the first side, and its arms."""
        r, R, v, w = self._unpacked(y)
        places = [self._index[side.body] for side in (spring.first, spring.second)]
        arms = [R[k] @ self._arm(s) for k, s in zip(places, (spring.first, spring.second), strict=True)]
        p = [r[k] + arm for k, arm in zip(places, arms, strict=True)]
        u = [v[k] + np.cross(w[k], arm) for k, arm in zip(places, arms, strict=True)]
        length = float(np.linalg.norm(p[1] - p[0]))
        direction = (p[1] - p[0]) / length
        return length, float(direction @ (u[1] - u[0])), direction, arms

    def _weighted(self, J: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the Jacobian (m, 6 n) of mass-weighted velocities."""
        turn = matrices(y[:, 3:7]) @ self.weight
        linear = J[:, :, :3] / np.sqrt(self.mass)[:, None]
        angular = np.einsum("mni,nij->mnj", J[:, :, 3:], turn)
        return np.concatenate([linear, angular], axis=2).reshape(self.rows, -1)

    def _unweighted(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return velocities (n, 6) of mass-weighted ones (6 n,)."""
        x = x.reshape(-1, 6)
        turn = matrices(y[:, 3:7]) @ self.weight
        return np.concatenate([x[:, :3] / np.sqrt(self.mass)[:, None], turned(turn, x[:, 3:])], axis=1)


def _least(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the least-squares solution of minimum norm."""
    return lstsq(matrix, right, cond=_RANK, lapack_driver="gelsy", check_finite=False)[0]
