"""Session: a run commanded from outside, as in a control loop or a co-simulation."""

from antenna_pin.base.lazy import exported

exported(__name__)
