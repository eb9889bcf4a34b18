"""From measured records to numbers of a scenario: what play, stiffness, friction a joint has."""

from antenna_pin.base.lazy import exported

exported(__name__)
