"""A run that is commanded from outside, step by step: in a control loop, an environment, a co-simulation."""

from antenna_pin.base.lazy import exported

exported(__name__)
