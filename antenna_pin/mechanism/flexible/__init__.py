"""Flexible links: a rigid link as a hub with bodies on sprung joints.

What stays and what moves are together the link: mass, mass centre and inertia are kept exactly.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
