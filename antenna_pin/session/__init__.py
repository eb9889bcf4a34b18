"""A run that is commanded from outside, step by step: in a control loop, an environment, a co-simulation."""

from antenna_pin._lazy import only_public
from antenna_pin.session.session import EndedError, InUseError, Session, start

__all__ = ["EndedError", "InUseError", "Session", "start"]

only_public(__name__)
