"""Benchmark problems of multibody dynamics with closed loops, and what is known of each.

They are A01 to A04 of IFToMM's library of computational benchmark problems (Gonzalez, Dopico, Lugris and
Cuadrado 2006, Multibody System Dynamics 16, 213-229). All move under their weight, or under a motor, without
losses. The reference of A01 and A02 is in closed form, that of A04 one equation for one angle; A03 is that of
Schiehlen (1990) with the solution of the test set for initial value problem solvers (Mazzia and Magherini
2008), to 14 digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from bench_tools import Array
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk, ellipkinc

GRAVITY = 9.81  # [m/s^2], along -y


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A benchmark problem."""

    name: str  # number and name
    urdf: str  # its tree
    closures: str  # what closes it and where it starts, TOML
    duration: float  # [s]
    angle: str  # joint by which it is known
    # Angle [rad] and rate [rad/s] of that joint at times [s]; None where something else is known.
    reference: Callable[[Array], tuple[Array, Array]] | None = None
    gravity: float = GRAVITY  # along -y [m/s^2]

    @property
    def scenario(self) -> str:
        """The scenario of ``mechanism.urdf``, TOML."""
        return f"""\
format = 1
title = "{self.name}"
duration = {self.duration}

[mechanism]
urdf = "mechanism.urdf"
base = "fixed"
gravity = [0.0, {-self.gravity}, 0.0]

{self.closures}
"""


# --- a tree in URDF, in the plane x-y unless an axis says otherwise ---


def link(name: str, mass: float, centre: Sequence[float], inertia: float | Sequence[float]) -> str:
    """Return a link; its inertia about z, or about three axes, through the mass centre [kg m^2]."""
    moments = (inertia, inertia, inertia) if isinstance(inertia, float) else inertia
    words = " ".join(f'i{axis}{axis}="{float(i)!r}"' for axis, i in zip("xyz", moments, strict=True))
    return (
        f'<link name="{name}"><inertial><origin xyz="{numbers(centre)}"/><mass value="{mass!r}"/>'
        f'<inertia {words} ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def hinge(
    name: str, parent: str, child: str, place: Sequence[float], axis: Sequence[float] = (0, 0, 1)
) -> str:
    """Return a joint that turns without end, at a place in the parent [m]."""
    return (
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{numbers(place)}"/><axis xyz="{numbers(axis)}"/></joint>'
    )


def robot(*parts: str) -> str:
    """Return a URDF."""
    return "\n".join(['<robot name="benchmark">', '<link name="ground"/>', *parts, "</robot>\n"])


def numbers(values: Sequence[float]) -> str:
    """Return numbers as URDF has them, points of the plane with z = 0."""
    return " ".join(repr(float(value)) for value in (*values, 0.0)[:3])


def closure(
    name: str,
    first: str,
    point: Sequence[float],
    second: str,
    other: Sequence[float],
    axis: Sequence[float] = (0, 0, 1),
) -> str:
    """Return a revolute closure of two links, TOML."""
    sides = (
        f'{{ link = "{one}", point = {[float(x) for x in (*at, 0.0)[:3]]}, axis = {list(axis)} }}'
        for one, at in ((first, point), (second, other))
    )
    return f'[closures.{name}]\nkind = "revolute"\nfirst = {next(sides)}\nsecond = {next(sides)}\n'


def start(joint: str, position: float, velocity: float = 0.0, *, guess: bool = False) -> str:
    """Return where a joint starts, or where its start is looked for, TOML."""
    words = "guess = true\n" if guess else f"velocity = {velocity!r}\n"
    return f"[initial.joints.{joint}]\nposition = {position!r}\n{words}"


# --- A01 ---


def pendulum() -> Problem:
    """Return a mass of 1 kg on a rod of 1 m, let go level; the pin is a free joint closed by constraint.

    The library's is a point. A URDF asks for an inertia: 1e-6 kg m^2, which the reference has as well.
    """

    def reference(t: Array) -> tuple[Array, Array]:
        # From the lowest point k sn(K - w t); turned against gravity's direction by a right angle.
        rate, k = math.sqrt(GRAVITY / (1.0 + 1e-6)), math.sin(math.pi / 4.0)
        sn, cn, _, _ = ellipj(ellipk(k * k) - rate * t, k * k)
        return math.pi / 2.0 - 2.0 * np.arcsin(k * sn), 2.0 * k * rate * cn

    return Problem(
        name="A01 pendulum",
        urdf=robot(link("rod", 1.0, (-1.0, 0.0), 1e-6), hinge("pin", "ground", "rod", (0.0, 0.0))),
        closures='[clearance.pin]\nmodel = "constraint"\n',
        duration=10.0,
        angle="pin",
        reference=reference,
    )


# --- A02 ---


def four_bars(count: int) -> Problem:
    """Return a row of square four-bars of rods of 1 m and 1 kg, upright, their upper pins at 1 m/s.

    It goes round as one physical pendulum does. Whenever all rods lie in one line, each four-bar could fold
    as well: the freedoms are more by the number of four-bars there.
    """
    inertia = (1.0 / 12.0, 1e-9, 1.0 / 12.0)
    parts = [link("bar0", 1.0, (0.0, 0.5), inertia), hinge("pin0", "ground", "bar0", (0.0, 0.0))]
    closures = []
    for k in range(1, count + 1):
        parts += [
            link(f"bar{k}", 1.0, (0.0, 0.5), inertia),
            hinge(f"pin{k}", "ground", f"bar{k}", (float(k), 0.0)),
            link(f"top{k}", 1.0, (0.5, 0.0), (1e-9, 1.0 / 12.0, 1.0 / 12.0)),
            hinge(f"corner{k}", f"bar{k - 1}", f"top{k}", (0.0, 1.0)),
        ]
        closures.append(closure(f"end{k}", f"top{k}", (1.0, 0.0), f"bar{k}", (0.0, 1.0)))
    w2 = GRAVITY * (0.5 * (count + 1) + count) / ((count + 1) / 3.0 + count)

    def reference(t: Array) -> tuple[Array, Array]:
        # With the angle 2 a from the upright: a' = sqrt(1 + 4 w^2 sin^2 a) / 2, an elliptic integral.
        m = -4.0 * w2
        a = 0.5 * t
        for _ in range(60):
            slope = np.sqrt(1.0 - m * np.sin(a) ** 2)
            a = a - np.clip((ellipkinc(a, m) - 0.5 * t) * slope, -0.3, 0.3)
        return -2.0 * a, -np.sqrt(1.0 - m * np.sin(a) ** 2)

    return Problem(
        name=f"A02 {count} four-bars",
        urdf=robot(*parts),
        closures="\n".join([*closures, start("pin0", 0.0, -1.0)]),
        duration=10.0,
        angle="pin0",
        reference=reference,
    )


# --- A03 ---

SQUEEZER = {
    "beta": (-0.0617138900142764496, 0.1581077119629904e2, 0.1139920302151208e4),
    "theta": (0.0, -0.1575637105984298e2, -0.1424379294994111e4),
    "gamma": (0.455279819163070380, 0.4082224013073101e-1, 0.1103291221937134e2),
    "phi": (0.222668390165885885, -0.5347301163226948, 0.1929337464421385e2),
    "delta": (0.487364979543842550, 0.5244099658805304, 0.5735699284790808),
    "omega": (-0.222668390165885885, 0.5347301163226948, -0.1929337464421385e2),
    "epsilon": (1.23054744454982119, 0.1048080741042263e1, 0.3231791658026955),
}
"""Published: angles at the start and at 0.03 s [rad], rates then [rad/s]; joints are called by them."""


def squeezer() -> Problem:
    """Return Andrews' squeezing mechanism: three loops of seven bodies, a motor of 33 mN m, a spring."""
    a, b = (-0.06934, -0.00227), (-0.03635, 0.03273)
    guesses = [
        start(joint, round(values[0], 2), guess=True) for joint, values in SQUEEZER.items() if joint != "beta"
    ]
    return Problem(
        name="A03 Andrews' squeezer",
        urdf=robot(
            link("crank", 0.04325, (0.00092, 0.0), 2.194e-6),
            link("rod", 0.00365, (-0.0115, 0.0), 4.410e-7),
            link("triangle", 0.02373, (0.01043, -0.01874), 5.255e-6),
            link("plate_g", 0.00706, (0.0, -(0.02 - 0.01421)), 5.667e-7),
            link("arm_g", 0.07050, (0.02308, 0.00916), 1.169e-5),
            link("plate_h", 0.00706, (0.02 - 0.01421, 0.0), 5.667e-7),
            link("arm_h", 0.05498, (-0.00449, -0.01228), 1.912e-5),
            hinge("beta", "ground", "crank", (0.0, 0.0)),
            hinge("theta", "crank", "rod", (0.007, 0.0)),
            hinge("gamma", "ground", "triangle", b),
            hinge("delta", "ground", "arm_g", a),
            hinge("phi", "arm_g", "plate_g", (0.04, 0.0)),
            hinge("epsilon", "ground", "arm_h", a),
            hinge("omega", "arm_h", "plate_h", (0.0, -0.04)),
        ),
        closures="\n".join(
            [
                closure("triangle", "rod", (-0.028, 0.0), "triangle", (0.0, -0.035)),
                closure("plate_g", "rod", (-0.028, 0.0), "plate_g", (0.0, -0.02)),
                closure("plate_h", "rod", (-0.028, 0.0), "plate_h", (0.02, 0.0)),
                '[drives.motor]\nkind = "constant"\njoint = "beta"\nvalue = 0.033\n',
                "[springs.spring]\nstiffness = 4530.0\nfree_length = 0.07785",
                'first = { link = "triangle", point = [0.02, -0.018, 0.0] }',
                'second = { link = "world", point = [0.014, 0.072, 0.0] }\n',
                start("beta", SQUEEZER["beta"][0]),
                *guesses,
            ]
        ),
        duration=0.03,
        angle="beta",
        gravity=0.0,
    )


# --- A04 ---

_POINTS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
_AXES = ((0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0))


def _along(k: int) -> tuple[Array, Array]:
    """Return bar k of the ring at the start [m], and its moments of inertia [kg m^2]."""
    bar = _POINTS[k + 1] - _POINTS[k]
    square = np.abs(bar)
    return bar, (1.0 - square) * (1.0 + 0.1**2) / 12.0 + square * 0.1**2 / 6.0


def bricard() -> Problem:
    """Return Bricard's ring of five bars of 1 m and 1 kg, 0.1 m square, on a cube: let go from rest."""
    parts, before = [], "ground"
    for k in range(5):
        bar, inertia = _along(k)
        place = _POINTS[k] - _POINTS[k - 1] if k else _POINTS[0]
        parts += [
            link(f"bar{k}", 1.0, 0.5 * bar, inertia),
            hinge(f"pin{k}", before, f"bar{k}", place, _AXES[k]),
        ]
        before = f"bar{k}"
    ends = closure("pin5", "bar4", _POINTS[5] - _POINTS[4], "world", _POINTS[5], _AXES[5])
    return Problem(
        name="A04 Bricard's ring",
        urdf=robot(*parts),
        closures=ends + "\n" + start("pin0", 0.0),
        duration=10.0,
        angle="pin0",
        reference=_ring_angle,
    )


def _ring_poses(p: complex) -> tuple[list[Array], list[Array]]:
    """Return mass centres and attitudes of the five bars for the first pin's angle, a complex one too.

    Every second angle is p, the others q with sin p + sin q + sin p sin q = 0 (Bricard 1897).
    """
    q = np.arcsin(-np.sin(p) / (1.0 + np.sin(p)))
    place, attitude = _POINTS[0].astype(complex), np.eye(3, dtype=complex)
    centres, attitudes = [], []
    for k in range(5):
        angle = q if k % 2 else p
        u = np.array(_AXES[k], float)
        skew = np.cross(np.eye(3), u)
        attitude = attitude @ (np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew)
        bar, _ = _along(k)
        centres.append(place + 0.5 * attitude @ bar)
        attitudes.append(attitude)
        place = place + attitude @ bar
    return centres, attitudes


@cache
def _ring_energy(p: float) -> tuple[float, float]:
    """Return what half the rate's square is multiplied by in the kinetic energy, and the potential energy."""
    step = 1e-30
    centres, attitudes = _ring_poses(p + 1j * step)
    inertia = height = 0.0
    for k, (centre, attitude) in enumerate(zip(centres, attitudes, strict=True)):
        velocity = centre.imag / step
        spin = attitude.real.T @ (attitude.imag / step)
        turn = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        inertia += velocity @ velocity + turn @ (_along(k)[1] * turn)
        height += centre[1].real
    return inertia, GRAVITY * height


def _ring_angle(t: Array) -> tuple[Array, Array]:
    """Solve p'' = -(V' + I' p'^2 / 2) / I, with derivatives by central differences of sixth order."""
    h = 1e-3
    weights = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / (60.0 * h)

    def slope(_: float, y: Array) -> Array:
        near = np.array([_ring_energy(y[0] + k * h) for k in (-3, -2, -1, 1, 2, 3)])
        inertia_rate, force = weights @ near
        return np.array([y[1], -(force + 0.5 * inertia_rate * y[1] ** 2) / _ring_energy(y[0])[0]])

    found = solve_ivp(slope, (0.0, t[-1]), [0.0, 0.0], "DOP853", t, rtol=1e-12, atol=1e-13)
    return found.y[0], found.y[1]
