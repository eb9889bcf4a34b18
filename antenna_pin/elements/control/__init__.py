"""Sampled controllers: measurement and command at sampling times.

A controller is no force element (:mod:`antenna_pin.elements`): it sets the number of drives, motors and
thrusters that takes commands. It contains no mechanics; a run passes it :class:`Now`.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
