"""Flexible links: a rigid link as a hub with bodies on joints against springs. Numbers in, numbers out.

What stays and what moves are together the link: mass, mass centre and inertia are kept exactly.
"""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.flexible.inertia import MassProperties, least_share, share_taken
    from antenna_pin.flexible.kind import FlexibleKind
    from antenna_pin.flexible.modal_data import ModalData
    from antenna_pin.flexible.modes import EffectiveMode, EffectiveModes
    from antenna_pin.flexible.part import (
        BoxShape,
        CylinderShape,
        Drawn,
        ElasticPart,
        MeshShape,
        SphereShape,
        Takes,
    )
    from antenna_pin.flexible.petals import Petals, petal_body
    from antenna_pin.flexible.realised import realised
    from antenna_pin.flexible.split import SplitLink, split

__all__ = [
    "BoxShape",
    "CylinderShape",
    "Drawn",
    "EffectiveMode",
    "EffectiveModes",
    "ElasticPart",
    "FlexibleKind",
    "MassProperties",
    "MeshShape",
    "ModalData",
    "Petals",
    "SphereShape",
    "SplitLink",
    "Takes",
    "least_share",
    "petal_body",
    "realised",
    "share_taken",
    "split",
]

loaded_when_used(
    __name__,
    {
        "inertia": "MassProperties least_share share_taken",
        "kind": "FlexibleKind",
        "modal_data": "ModalData",
        "modes": "EffectiveMode EffectiveModes",
        "part": "BoxShape CylinderShape Drawn ElasticPart MeshShape SphereShape Takes",
        "petals": "Petals petal_body",
        "realised": "realised",
        "split": "SplitLink split",
    },
)
