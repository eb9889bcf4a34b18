"""A scenario explored live: sliders in a browser, half a second of its run after each change."""

from antenna_pin.live.explored import Curve, Curves, Explored
from antenna_pin.live.knobs import Knob, knobs_of
from antenna_pin.live.runner import Made, Runner
from antenna_pin.live.server import Exploration, check_bokeh, explore

__all__ = [
    "Curve",
    "Curves",
    "Exploration",
    "Explored",
    "Knob",
    "Made",
    "Runner",
    "check_bokeh",
    "explore",
    "knobs_of",
]
