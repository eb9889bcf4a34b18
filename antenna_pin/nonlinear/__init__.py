"""What motions come to: sections, diagrams, periodic solutions, their stability, and how neighbours part."""

from antenna_pin.base.lazy import exported

exported(__name__)
