"""A session as a screen shows it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from antenna_pin.base.readable import readable
from antenna_pin.trajectory import Outcome

__all__ = ["on_screen"]

_LINES = 8  # of a kind


def on_screen(session: Any, units: Mapping[str, str]) -> str:
    """Return time, outcome, joints, contacts that touch and commands of a session, in lines.

    Args:
        session: The session.
        units: Of the numbers that are read at once, by name.
    """
    system = session.system
    lines = [f"Session of {system.mechanism.name} at t = {readable(session.time, 's', 6)}"]
    if session.outcome is not Outcome.COMPLETED:
        lines.append(f"  ended {session.message}")
    joints = [name.removesuffix(".angle") for name in units if name.endswith(".angle")]
    for joint in joints[:_LINES]:
        shown = [f"{readable(session[name], units[name], 6)}" for name in (f"{joint}.angle", f"{joint}.rate")]
        lines.append(f"  {joint}: {', '.join(shown)}")
    if len(joints) > _LINES:
        lines.append(f"  and {len(joints) - _LINES} joints more")
    touching = [name for name in system.contact_names if session[f"{name}.touching"]]
    if touching:
        lines.append(f"  touching: {', '.join(touching[:_LINES])}")
    commands = [f"{name} = {value:.6g}" for name, value in list(session.command.items())[:_LINES]]
    if commands:
        lines.append(f"  command: {', '.join(commands)}")
    return "\n".join(lines)
