"""A scenario explored live: sliders in a browser, half a second of its run after each change."""

from antenna_pin.base.lazy import exported

exported(__name__)
