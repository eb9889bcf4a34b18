"""``<dynamics>`` of joints: their own damping and friction."""

from __future__ import annotations

from typing import Any

from antenna_pin.mechanism._format import numbers_in
from antenna_pin.mechanism._plain import WITH_AXIS

__all__ = ["friction_of", "left_out"]


def friction_of(robot: Any) -> dict[str, dict[str, float]]:
    """Return damping and friction above zero of joints with an axis, by name; what is no number is not."""
    found = {
        str(joint.get("name")): _numbers(joint)
        for joint in robot.findall("joint")
        if joint.get("type") in WITH_AXIS
    }
    return {name: numbers for name, numbers in found.items() if numbers}


def left_out(robot: Any, where: str) -> tuple[str, ...]:
    """Return a line for each joint's damping or friction that has no axis to act about."""
    return tuple(
        f"{where}: joint {joint.get('name')!r}: <dynamics> {name}={value:g} is not simulated, for the "
        f"joint is {joint.get('type')} and has no axis; take it out"
        for joint in robot.findall("joint")
        if joint.get("type") in ("floating", "planar")
        for name, value in _numbers(joint).items()
    )


def _numbers(joint: Any) -> dict[str, float]:
    found = {}
    for dynamics in joint.findall("dynamics")[:1]:
        for name in ("damping", "friction"):
            numbers = numbers_in(dynamics.get(name))
            if numbers is not None and len(numbers) == 1 and numbers[0]:
                found[name] = numbers[0]
    return found
