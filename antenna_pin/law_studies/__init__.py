"""Studies of the contact laws: what they do in an impact, side by side, and against a measured joint."""

from antenna_pin.base.lazy import exported

exported(__name__)
