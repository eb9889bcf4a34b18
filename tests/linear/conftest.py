"""Mechanisms whose small motions are known in closed form."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from antenna_pin import Mechanism, Urdf, build_mechanism


def _link(name: str, mass: float) -> str:
    return (
        f'<link name="{name}"><inertial><mass value="{mass}"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _slide(name: str, parent: str, child: str) -> str:
    return (
        f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
    )


@pytest.fixture
def chain() -> Callable[..., Mechanism]:
    """A function that makes a row of carriages, each sliding on the one before; the first is the base."""

    def make(masses: list[float], base: str = "free", gravity: tuple[float, ...] = (0, 0, 0)) -> Mechanism:
        links = "".join(_link(f"m{k}", mass) for k, mass in enumerate(masses))
        joints = "".join(_slide(f"s{k}", f"m{k - 1}", f"m{k}") for k in range(1, len(masses)))
        text = f'<robot name="chain">{links}{joints}</robot>'
        return build_mechanism(Urdf.from_text(text, "chain"), base, gravity)

    return make
