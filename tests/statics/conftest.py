"""Mechanisms whose statics are known in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from antenna_pin import Mechanism, Urdf, build_mechanism
from antenna_pin.dynamics.constraints import Anchor, Closure

BAR = """<robot name="bar"><link name="bus"/><link name="bar"><inertial>
<origin xyz="0.5 0 0"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="{kind}"><parent link="bus"/><child link="bar"/><axis xyz="0 0 1"/>
<limit lower="-1.5" upper="1.5" effort="1" velocity="1"/></joint></robot>"""


def _body(name: str, length: float, mass: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="{length / 2} 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _hinge(name: str, parent: str, child: str, at: float) -> str:
    return (
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at} 0 0"/><axis xyz="0 0 1"/></joint>'
    )


@pytest.fixture
def bar() -> Callable[..., Mechanism]:
    """A function that makes a bar of 2 kg on a hinge about z, its centre of mass at 0.5 m along x."""

    def make(gravity: float = 0.0, kind: str = "revolute") -> Mechanism:
        return build_mechanism(Urdf.from_text(BAR.format(kind=kind), "bar"), "fixed", (0.0, -gravity, 0.0))

    return make


@pytest.fixture
def four_bar() -> Callable[..., Any]:
    """A function that makes a four-bar linkage of three rods, and the closure to its fourth pivot."""

    def make(lengths: tuple[float, float, float], gravity: float) -> tuple[Mechanism, dict[str, Closure]]:
        a, b, c = lengths
        text = (
            '<robot name="four_bar"><link name="ground"/>'
            + _body("crank", a, 1.0)
            + _body("rod", b, 2.0)
            + _body("rocker", c, 3.0)
            + _hinge("crank", "ground", "crank", 0.0)
            + _hinge("pin", "crank", "rod", a)
            + _hinge("knee", "rod", "rocker", b)
            + "</robot>"
        )
        mechanism = build_mechanism(Urdf.from_text(text, "four_bar"), "fixed", (0.0, -gravity, 0.0))
        closure = Closure(
            kind="revolute",
            first=Anchor.at("world", point=(1.0, 0.0, 0.0)),
            second=Anchor.at("rocker", point=(c, 0.0, 0.0)),
        )
        return mechanism, {"pivot": closure}

    return make
