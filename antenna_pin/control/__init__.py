"""Sampled controllers: they measure and command at instants of their own.

A controller is no force element (:mod:`antenna_pin.elements`): it sets the one number of drives, motors and
thrusters that takes commands. Nothing here knows mechanics; a run asks controllers by :class:`Now`.
"""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.control.attitude import AttitudeFeedback
    from antenna_pin.control.controller import Controller, Instants, Now, check_controller
    from antenna_pin.control.limits import limited
    from antenna_pin.control.measure import Measure, measures_of
    from antenna_pin.control.memory import kept, remembered
    from antenna_pin.control.pid import Course, Pid, PidState
    from antenna_pin.control.registry import CONTROLLERS
    from antenna_pin.control.relay import BangBang, BangBangState
    from antenna_pin.control.sensor import Sensor
    from antenna_pin.control.state_feedback import Matrix, StateFeedback

__all__ = [
    "AttitudeFeedback",
    "BangBang",
    "BangBangState",
    "Matrix",
    "StateFeedback",
    "CONTROLLERS",
    "Controller",
    "Course",
    "Instants",
    "Measure",
    "Now",
    "Pid",
    "PidState",
    "Sensor",
    "check_controller",
    "kept",
    "limited",
    "measures_of",
    "remembered",
]

loaded_when_used(
    __name__,
    {
        "attitude": "AttitudeFeedback",
        "controller": "Controller Instants Now check_controller",
        "limits": "limited",
        "measure": "Measure measures_of",
        "memory": "kept remembered",
        "pid": "Course Pid PidState",
        "registry": "CONTROLLERS",
        "relay": "BangBang BangBangState",
        "sensor": "Sensor",
        "state_feedback": "Matrix StateFeedback",
    },
)
