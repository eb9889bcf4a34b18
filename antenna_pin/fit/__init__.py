"""From measured records to numbers of a scenario: what play, stiffness, friction a joint has."""

from antenna_pin._lazy import exported

exported(__name__)
