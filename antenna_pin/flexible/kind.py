"""Protocol of flexible links."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from antenna_pin.flexible.inertia import MassProperties
from antenna_pin.flexible.part import Drawn, ElasticPart

__all__ = ["FlexibleKind"]


class FlexibleKind(Protocol):
    """A way to make a link flexible."""

    __slots__ = ()

    @property
    def frequencies(self) -> Mapping[str, float]:
        """Natural frequencies with the hub held, by part, without the link's name [Hz]."""
        ...

    @property
    def removes(self) -> tuple[str, ...]:
        """Names of the link's shapes that are not drawn any more."""
        return ()

    @property
    def hub_drawn(self) -> tuple[Drawn, ...]:
        """Shapes of the hub, besides the link's own."""
        return ()

    def told_of(self, part: int, link: MassProperties) -> str:
        """Return details of a part for a refusal: the place of its numbers, for instance.

        Args:
            part: Its place in :meth:`parts`.
            link: The whole link.
        """
        return ""

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the elastic parts of a link.

        Args:
            name: Of the flexible link; the parts' names begin with it.
            link: The whole link.
        """
        ...
