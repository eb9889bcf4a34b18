"""A coupling: a joint of which the position follows that of another, as in a gear or a rack and pinion."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.parameters import check, parameter

__all__ = ["Coupling", "check_order", "spread"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    r"""A joint held to a multiple of another joint's position; without play, exactly, and both ways.

    .. math:: \phi_\text{follower} = m\, \phi_\text{leader} + \phi_0

    It is held by constraint: a torque :math:`\lambda` acts about the follower's axis and :math:`-m \lambda`
    about the leader's, each with its reaction on the joint's parent. It does no work and keeps momentum.
    Angles count whole turns.

    Attributes:
        follower: Name of the joint that follows: revolute, continuous or prismatic, without play.
        leader: Name of the joint that it follows; of the same kinds, or one that does not move, at zero.
        multiplier: m [-]; of a sliding follower of a turning leader [m/rad], the other way round [rad/m].
        offset: phi_0, the follower's position where the leader's is zero [rad] ([m]).
    """

    follower: str
    leader: str
    multiplier: float = parameter("1", default=1.0)
    offset: float = parameter("rad", sliding="m", default=0.0)

    def __post_init__(self) -> None:
        """Check the numbers, and that there are two joints."""
        check(self)
        if self.follower == self.leader:
            raise InvalidParameterError(self, "leader", "another joint than the follower", self.leader)

    def led(self, position: float) -> float:
        """Return the follower's position for one of the leader's [rad] ([m])."""
        return self.multiplier * position + self.offset

    def leading(self, position: float) -> float:
        """Return the leader's position for one of the follower's; the multiplier is not zero."""
        return (position - self.offset) / self.multiplier


def check_order(couplings: Mapping[str, Coupling]) -> None:
    """Refuse joints that follow each other round in a circle.

    Raises:
        MechanismError: Names them.
    """
    leaders: dict[str, list[str]] = {}
    for one in couplings.values():
        leaders.setdefault(one.follower, []).append(one.leader)
    done: set[str] = set()

    def visit(joint: str, path: tuple[str, ...]) -> None:
        if joint in path:
            circle = [*path[path.index(joint) :], joint]
            raise MechanismError(
                f"couplings: a joint must not follow itself, got {' follows '.join(map(repr, circle))}; "
                "take one of these couplings away"
            )
        if joint not in done:
            for leader in leaders.get(joint, ()):
                visit(leader, (*path, joint))
            done.add(joint)

    for joint in leaders:
        visit(joint, ())


def spread(couplings: Collection[Coupling], known: Collection[str]) -> Iterator[tuple[Coupling, bool]]:
    """Yield couplings by which what is known of some joints tells of others, in an order in which it does.

    Where nothing is known of joints that hang together, the first leader counts as known.

    Args:
        couplings: Without circles.
        known: Names of joints of which it is known.

    Yields:
        A coupling, and whether it tells of its follower, or else of its leader.
    """
    told, left = set(known), list(couplings)
    while left:
        # From followers to leaders only where nothing is told the other way.
        for forward in (True, False):
            one = next((one for one in left if _tells(one, told, forward)), None)
            if one is not None:
                told.add(one.follower if forward else one.leader)
                yield one, forward
                break
        else:
            # Both ends are told of, or neither.
            followers = {one.follower for one in left}
            told.add(next((one.leader for one in left if one.leader not in followers | told), ""))
        left = [one for one in left if not {one.follower, one.leader} <= told]


def _tells(one: Coupling, told: Collection[str], forward: bool) -> bool:
    if forward:
        return one.leader in told and one.follower not in told
    return one.follower in told and one.leader not in told and one.multiplier != 0.0
