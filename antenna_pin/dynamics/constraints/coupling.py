"""Couplings: joints that follow one or two others, as in gears, racks and differentials."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Self

from antenna_pin.base.parameters import check, parameter
from antenna_pin.errors import InvalidParameterError, MechanismError


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    r"""A joint held, without play and in both directions, to multiples of others' positions.

    .. math:: \phi_\text{follower} = m\, \phi_\text{leader} + m_2\, \phi_\text{second} + \phi_0

    It is held by constraint: a torque :math:`\lambda` acts about the follower's axis, :math:`-m \lambda`
    about the leader's and :math:`-m_2 \lambda` about the second's, each with its reaction on the joint's
    parent: a housing that carries all of them on parallel axes takes :math:`-(1 - m - m_2) \lambda`. It does
    no work and conserves momentum. Angles count whole turns.

    Attributes:
        follower: Name of the following joint: revolute, continuous or prismatic, without play.
        leader: Name of the leading joint; of the same kinds, or a fixed one, at zero.
        multiplier: m [-]; of a sliding follower of a turning leader [m/rad], the other way round [rad/m].
        offset: phi_0, the follower's position where those of the leaders are zero [rad] ([m]).
        second: Name of a second leading joint, of the kinds of the leader; None for none.
        second_multiplier: m_2, in units as m.
    """

    follower: str
    leader: str
    multiplier: float = parameter("1", default=1.0)
    offset: float = parameter("rad", sliding="m", default=0.0)
    second: str | None = None
    second_multiplier: float = parameter("1", default=1.0)

    @classmethod
    def differential(cls, *, carrier: str, first: str, second: str) -> Self:
        """Return the coupling of a differential: the carrier's turn is the sides' mean."""
        return cls(follower=carrier, leader=first, multiplier=0.5, second=second, second_multiplier=0.5)

    @classmethod
    def planetary(cls, *, carrier: str, sun: str, ring: str, ratio: float) -> Self:
        """Return a planetary gear's coupling: (1 + ratio) carrier = sun + ratio ring.

        Args:
            carrier: Joint of the planets' carrier.
            sun: Joint of the sun.
            ring: Joint of the ring.
            ratio: Teeth of the ring over those of the sun, above 1.

        Raises:
            InvalidParameterError: The ratio is 1 or less.
        """
        if not ratio > 1.0:
            raise InvalidParameterError("Coupling.planetary", "ratio", "ring over sun, above 1", ratio)
        m = 1.0 / (1.0 + ratio)
        return cls(follower=carrier, leader=sun, multiplier=m, second=ring, second_multiplier=ratio * m)

    @property
    def leaders(self) -> tuple[str, ...]:
        """The joints that it follows."""
        return (self.leader,) if self.second is None else (self.leader, self.second)

    def __post_init__(self) -> None:
        """Check the numbers, and that there are two joints."""
        check(self)
        if self.follower == self.leader:
            raise InvalidParameterError(self, "leader", "another joint than the follower", self.leader)
        if self.second in (self.follower, self.leader):
            raise InvalidParameterError(self, "second", "a third joint", self.second)

    def led(self, position: float, second: float = 0.0) -> float:
        """Return the follower's position for those of the leaders [rad] ([m])."""
        return self.multiplier * position + self._further(second)

    def leading(self, position: float, second: float = 0.0) -> float:
        """Return the leader's position for the follower's and the second's; the multiplier is not zero."""
        return (position - self._further(second)) / self.multiplier

    def _further(self, second: float) -> float:
        return self.offset if self.second is None else self.offset + self.second_multiplier * second


def check_order(couplings: Mapping[str, Coupling]) -> None:
    """Refuse couplings that form a cycle.

    Raises:
        MechanismError: The message names the joints.
    """
    leaders: dict[str, list[str]] = {}
    for one in couplings.values():
        leaders.setdefault(one.follower, []).extend(one.leaders)
    done: set[str] = set()

    def visit(joint: str, path: tuple[str, ...]) -> None:
        if joint in path:
            circle = [*path[path.index(joint) :], joint]
            raise MechanismError(
                f"couplings: a joint must not follow itself, got {' follows '.join(map(repr, circle))}; "
                "remove one of these couplings"
            )
        if joint not in done:
            for leader in leaders.get(joint, ()):
                visit(leader, (*path, joint))
            done.add(joint)

    for joint in leaders:
        visit(joint, ())


def spread(couplings: Collection[Coupling], known: Collection[str]) -> Iterator[tuple[Coupling, bool]]:
    """Yield couplings in an order in which each determines further joints.

    If no joint of a connected set is known, the first leader counts as known. A second leader has no coupling
    of its own: it counts as known if nothing else determines it.

    Args:
        couplings: Couplings without cycles.
        known: Names of joints with known positions.

    Yields:
        A coupling, and whether it determines its follower, or else its leader.
    """
    told, left = set(known), list(couplings)
    while left:
        # From followers to leaders only if no coupling works the other way.
        for forward in (True, False):
            one = next((one for one in left if _tells(one, told, forward)), None)
            if one is not None:
                told.add(one.follower if forward else one.leader)
                yield one, forward
                break
        else:
            # Both ends are determined, or neither.
            followers = {one.follower for one in left}
            leaders = (name for one in left for name in one.leaders)
            told.add(next((name for name in leaders if name not in followers | told), ""))
        left = [one for one in left if not {one.follower, *one.leaders} <= told]


def _tells(one: Coupling, determined: Collection[str], forward: bool) -> bool:
    if one.second is not None and one.second not in determined:
        return False
    if forward:
        return one.leader in determined and one.follower not in determined
    return one.follower in determined and one.leader not in determined and one.multiplier != 0.0
