"""A scenario explored live: sliders in a browser, half a second of its run after each change."""

from antenna_pin._lazy import exported

exported(__name__)
