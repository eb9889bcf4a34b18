"""Statics in one call: equilibria, or travel and torque-angle loop of a joint."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import brief
from antenna_pin.dynamics import System
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.statics.equilibria import equilibria
from antenna_pin.studies.statics.quasi_static import travel
from antenna_pin.studies.statics.result import Equilibrium, QuasiStaticTravel
from antenna_pin.studies.statics.torque_angle import TorqueAngleLoop, torque_angle_loop


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Statics:
    """Statics of a mechanism.

    Attributes:
        equilibria: Equilibria, that next to the start first; () for a named joint.
        travel: Quasi-static travel of the joint; None without.
        loop: Torque-angle loop of the joint; None without.
    """

    __repr__ = brief

    equilibria: tuple[Equilibrium, ...] = ()
    travel: QuasiStaticTravel | None = None
    loop: TorqueAngleLoop | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return what was found in plain numbers."""
        found: dict[str, Any] = {}
        if self.equilibria:
            found["equilibria"] = [one.to_dict() for one in self.equilibria]
        for name, one in (("travel", self.travel), ("loop", self.loop)):
            if one is not None:
                found[name] = one.to_dict()
        return found


@takes()
def statics(
    model: Scenario | System | str | os.PathLike[str],
    joint: str | None = None,
    *,
    start: float | str | None = None,
    stop: float | str | None = None,
    count: int = 61,
    back: bool = True,
    loop: float | str | None = None,
    small_torque: float | str | None = None,
    hold: Sequence[str] = (),
    q: ArrayLike | None = None,
    starts: int = 16,
    seed: int = 0,
) -> Statics:
    """Return equilibria, or of a joint its quasi-static travel and its torque-angle loop.

    As ``antenna-pin statics``: equilibria without a joint; with one its travel, or with ``loop`` its
    torque-angle loop; both where ends of the travel are given too. Each is what :func:`equilibria`,
    :func:`travel` and :func:`torque_angle_loop` return.

    Args:
        model: A scenario, its name or path, or a system.
        joint: The joint, or a drive, which means the joint that it moves; none for equilibria.
        start: First position [rad] ([m]); the joint's lower limit if left out.
        stop: Last position [rad] ([m]); the joint's upper limit if left out.
        count: Number of positions, evenly spaced.
        back: Whether the joint is moved back too.
        loop: Amplitude of a torque-angle loop [N*m] ([N]).
        small_torque: Torque that determines the lost motion [N*m] ([N]).
        hold: Names of further joints that do not move.
        q: Configuration from which all begins, (nq,); the start if left out.
        starts: Number of random poses from which equilibria are searched.
        seed: Of these.

    Raises:
        AntennaPinError: What needs a joint without one, or as the functions above.
    """
    options = {"start": start, "stop": stop, "loop": loop}
    given = [name for name, value in options.items() if value is not None]
    if joint is None:
        if given:
            raise InvalidParameterError(
                "statics", given[0], "given with a joint", said=str(options[given[0]])
            )
        return Statics(equilibria=tuple(equilibria(model, q=q, hold=hold, starts=starts, seed=seed)))
    if small_torque is not None and loop is None:
        rule = "given with loop, the amplitude of a torque-angle loop"
        raise InvalidParameterError("statics", "small_torque", rule, said=str(small_torque))
    way = cycle = None
    if loop is None or start is not None or stop is not None:
        way = travel(model, joint, start=start, stop=stop, count=count, back=back, hold=hold, q=q)
    if loop is not None:
        cycle = torque_angle_loop(model, joint, loop, small_torque=small_torque, hold=hold, q=q)
    return Statics(travel=way, loop=cycle)
