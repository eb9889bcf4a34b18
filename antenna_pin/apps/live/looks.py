"""Style of the explorer's page: colours, type, dark mode."""

from __future__ import annotations

import json
from typing import Any

from bokeh.models import CustomJS

#: Those of the figures, told apart by the colour-blind too; what they were before is grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_ON_DARK = ("#58B4F0", "#FF8F45", "#2FCB9B", "#E7A0CB", "#F2BC4B", "#8CD0F5")
REFERENCE = "#8a94a0"
#: Seen on white and on black.
OUTLINE = "#7d8794"

# Widgets stand in shadows of their own, which the page's style does not reach.
STYLE = """
:host { color: inherit; font: inherit; }
h2 { margin: 10px 0 2px; font-size: 13px; }
.refused { color: #a1260d; font-weight: 600; }
.about { display: inline-block; min-width: 6em; color: #556070; }
.soft { color: #556070; }
.bk-input { height: 26px; padding: 0 6px; font-size: 13px; text-align: right; }
select.bk-input { text-align: left; padding-right: 20px; accent-color: currentcolor; }
.bk-slider-title, label { font-size: 13px; }
.noUi-handle:focus-visible, button:focus-visible, .bk-input:focus-visible {
  outline: 2px solid #0072b2; outline-offset: 1px;
}
@media (prefers-color-scheme: dark) {
  .refused { color: #ff9a8a; }
  .about, .soft { color: #a9b3c0; }
  .bk-input { background-color: #1b1f25; color: #e6e9ee; border-color: #46505d; }
  .bk-btn { background-color: #2a3038; color: #e6e9ee; border-color: #46505d; }
  .bk-btn:hover { background-color: #39414b; }
  .noUi-target { background: #39414b; border-color: #46505d; box-shadow: none; }
  .noUi-handle { background: #a9b3c0; border-color: #46505d; box-shadow: none; }
}
"""

_DARKENED = """
const COLOURS = PAIRS;
const wish = matchMedia('(prefers-color-scheme: dark)');
function dress() {
  const dark = ['#e6e9ee', '#1b1f25', '#333b45'], light = ['#1c2430', '#ffffff', '#e4e8ed'];
  const [ink, paper, grid] = wish.matches ? dark : light;
  for (const figure of columns.flatMap((column) => column.children)) {
    if (figure.below === undefined) continue;
    figure.background_fill_color = paper;
    figure.border_fill_color = paper;
    figure.title.text_color = ink;
    for (const axis of [...figure.below, ...figure.left]) {
      axis.axis_label_text_color = ink;
      axis.major_label_text_color = ink;
      axis.axis_line_color = ink;
      axis.major_tick_line_color = ink;
    }
    for (const {glyph} of figure.renderers) {
      const k = COLOURS.findIndex((pair) => pair.includes(glyph.line_color?.value));
      // The server needs no value of this kind.
      if (k >= 0) glyph.setv({ line_color: COLOURS[k][wish.matches ? 1 : 0] }, { sync: false });
    }
    for (const one of [...figure.center, ...figure.above]) {
      if (one.grid_line_color !== undefined) one.grid_line_color = grid;
      if (one.label_text_color === undefined) continue;
      one.label_text_color = ink;
    }
  }
}
dress();
if (!columns[0].watched) wish.addEventListener('change', dress);
columns[0].watched = true;
"""


def darkened(columns: list[Any]) -> CustomJS:
    """Return the script that colours figures by the system's light or dark mode."""
    pairs = json.dumps(list(zip(COLOURS, _ON_DARK, strict=True)))
    return CustomJS(args={"columns": columns}, code=_DARKENED.replace("PAIRS", pairs))


_SQUARE = """
const half = corners.data.x.length ? corners.data.x[1] : 0;
const [width, height] = [figure.inner_width, figure.inner_height];
if (half > 0 && width > 0 && height > 0) {
  const unit = half / Math.min(width, height);
  figure.x_range.setv({ start: -unit * width, end: unit * width });
  figure.y_range.setv({ start: -unit * height, end: unit * height });
}
"""


def squared(figure: Any, corners: Any) -> None:
    """Keep the scales of both axes equal around a square of two corners."""
    fitted = CustomJS(args={"figure": figure, "corners": corners}, code=_SQUARE)
    for side in ("inner_width", "inner_height"):
        figure.js_on_change(side, fitted)
    corners.js_on_change("data", fitted)


def dressed(widget: Any) -> Any:
    """Return a widget in the page's style."""
    widget.stylesheets = [STYLE]
    return widget
