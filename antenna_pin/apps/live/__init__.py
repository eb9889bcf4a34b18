"""Live exploration of a scenario: sliders in a browser, a run after each change."""

from antenna_pin.base.lazy import exported

exported(__name__)
