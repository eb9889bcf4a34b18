"""Sampled controllers: they measure and command at instants of their own.

A controller is no force element (:mod:`antenna_pin.elements`): it sets the one number of drives, motors and
thrusters that takes commands. Nothing here knows mechanics; a run asks controllers by :class:`Now`.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
