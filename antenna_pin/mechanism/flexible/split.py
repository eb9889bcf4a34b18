"""Rigid link split into a hub and elastic parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.flexible.inertia import MassProperties, least_share, share_taken
from antenna_pin.mechanism.flexible.parts import Drawn, ElasticPart, FlexibleKind

# A hub that has less than this of some moment of its link is one on paper only: round-off decides about it.
_LEAST = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class SplitLink:
    """A link as a hub with elastic parts; together they are the link.

    Attributes:
        hub: What stays, in the link's frame.
        parts: What moves.
        removes: Names of the link's shapes that are not drawn any more.
        hub_shapes: What is drawn of the hub, beside the link's own shapes.
    """

    hub: MassProperties
    parts: tuple[ElasticPart, ...]
    removes: tuple[str, ...] = ()
    hub_shapes: tuple[Drawn, ...] = ()


def split(kind: FlexibleKind, name: str, link: MassProperties, where: str) -> SplitLink:
    """Return a link as a hub with elastic parts.

    Raises:
        MechanismError: No body can be what is left; it names which part asks too much.
    """
    if not link.mass > 0.0:
        raise MechanismError(
            f"{where}: the link's mass must be positive to be shared out, got {link.mass:g} kg"
        )
    if not np.any(link.inertia) or least_share(link, link.moments) <= _LEAST:
        moments = ", ".join(f"{moment:.6g}" for moment in np.linalg.eigvalsh(link.inertia))
        raise MechanismError(
            f"{where}: the link's principal moments of inertia must be those of a body with some thickness "
            f"to be shared out, got {moments} kg m^2"
        )
    parts = kind.parts(name, link)
    left = link.moments
    for k, part in enumerate(parts):
        if part.body.mass >= link.mass:
            raise MechanismError(
                f"{where}: {part.name} must be lighter than its link, {link.mass:.6g} kg, got "
                f"{part.body.mass:.6g} kg{kind.part_note(k, link)}"
            )
        before, left = left, left - part.body.moments
        if least_share(link, left) <= _LEAST:
            raise MechanismError(
                f"{where}: {_too_much(link, parts[: k + 1], before, left)}{kind.part_note(k, link)}"
            )
    return SplitLink(link.less(part.body for part in parts), tuple(parts), kind.removes, kind.hub_shapes)


def _too_much(
    link: MassProperties, parts: Sequence[ElasticPart], before: np.ndarray, left: np.ndarray
) -> str:
    """Refuse a part that needs more mass or inertia than the link has, by name."""
    part = parts[-1]
    beside = "" if len(parts) == 1 else f" in addition to {', '.join(one.name for one in parts[:-1])}"
    asks = f"it takes {100.0 * share_taken(link, part.body):.3g} % of a moment of the link's mass"
    if left[3, 3] <= 0.0:
        return (
            f"{part.name} needs {part.body.mass:.6g} kg{beside}, of {before[3, 3]:.6g} kg left of the "
            "link; reduce it"
        )
    moments = np.linalg.eigvalsh(MassProperties.of_moments(left).inertia)
    said = ", ".join(f"{moment:.4g}" for moment in moments)
    return (
        f"{part.name} takes too much inertia{beside}: the hub would have principal moments of inertia of "
        f"{said} kg m^2, which is impossible for a body ({asks}); reduce it, or place it nearer to the "
        "link's mass centre"
    )
