"""Three figures of the page: a run beside the one compared with."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import BasicTickFormatter, Column, ColumnDataSource, Div, HoverTool
from bokeh.plotting import figure

from antenna_pin.apps.live.explored import Curve, Curves
from antenna_pin.apps.live.looks import COLOURS, OUTLINE, REFERENCE, dressed, squared
from antenna_pin.base.readable import prefixed, printed_unit

_AROUND = 1.15  # of the outline, that is in view beside it
_NOTHING: dict[str, object] = {"x": np.zeros(0), "y": np.zeros(0)}
_TOOLS = "pan,box_zoom,wheel_zoom,reset"


class Panels:
    """The figures, made for the curves that a joint has.

    Attributes:
        columns: What holds them in the page, one each.
    """

    def __init__(self) -> None:
        """Make room for them."""
        self.columns = [
            Column(Div(), name=name, sizing_mode="stretch_both") for name in ("first", "second", "third")
        ]
        self._made: tuple[str, ...] = ()
        self._now: list[ColumnDataSource] = []
        self._before: list[ColumnDataSource] = []
        self._outline = ColumnDataSource({"x": [], "y": []}, name="outline")
        self._corners = ColumnDataSource(_NOTHING)
        self._factor = 1.0
        self._compared: Curves | None = None

    def announce(self, text: str) -> None:
        """Show a text (HTML) where the first figure will be."""
        self.columns[0].children = [dressed(Div(text=text))]

    def forget(self) -> None:
        """Rebuild the panels at the next run: another joint is selected."""
        self._made = ()

    def show(self, curves: Curves, reference: Curves | None) -> None:
        """Show a run beside another one."""
        panels = (curves.first, curves.second, curves.third)
        names = tuple(curve.name for panel in panels for curve in panel)
        made = self._make(curves) if names != self._made else []
        self._made = names
        pairs = [(self._now, curves), (self._before, reference)]
        if reference is self._compared and not made:
            del pairs[1]
        self._compared = reference
        for sources, shown in pairs:
            every = [] if shown is None else [*shown.first, *shown.second, *shown.third]
            if shown is not None and len(every) != len(sources):
                every = []
            for k, source in enumerate(sources):
                source.data = self._columns(every[k], k < len(curves.first)) if every else _NOTHING
        x, y = (self._factor * curves.outline[:, axis] for axis in (0, 1))
        self._outline.data = {"x": np.append(x, x[:1]), "y": np.append(y, y[:1])}
        if len(x):
            self._frame(self._factor * max(np.abs(curves.outline).max(), _reach(curves.first)))
        for column, one in zip(self.columns, made, strict=False):  # with their data, whose ranges they take
            column.children = [one]

    def _columns(self, curve: Curve, across: bool) -> dict[str, object]:
        """Return a curve as a source has it; a path in the panel's unit."""
        factor = self._factor if across and self._is_path else 1.0
        return {"x": factor * curve.x, "y": factor * curve.y}

    def _make(self, curves: Curves) -> list[Any]:
        self._is_path = len(curves.outline) > 0
        self._now, self._before = [], []
        made = []
        for panel, title in zip(
            (curves.first, curves.second, curves.third), self._titles(curves), strict=True
        ):
            path = panel is curves.first and self._is_path
            self._factor, unit = prefixed("m", [np.abs(curves.outline).max()]) if path else (self._factor, "")
            one = figure(
                title=title,
                sizing_mode="stretch_both",
                tools=_TOOLS,
                active_scroll=None,
                **({"x_range": (-1.0, 1.0), "y_range": (-1.0, 1.0)} if path else {}),
                x_axis_label=f"across the bearing [{unit}]" if path else "time [s]",
                y_axis_label=f"[{unit if path else printed_unit(panel[0].unit)}]",
                min_border_left=10,
            )
            one.outline_line_color = None
            one.toolbar.autohide = True
            one.toolbar.logo = None
            one.title.text_font_size = "13px"
            one.axis.axis_label_text_font_style = "normal"
            one.axis.formatter = BasicTickFormatter(power_limit_low=-5, power_limit_high=6)  # 0.003, not 3e-3
            # As many as stand side by side on a phone.
            one.xaxis.ticker.desired_num_ticks = 4 if panel is curves.third else 3
            one.axis.minor_tick_line_color = None
            if path:
                squared(one, self._corners)
                one.line("x", "y", source=self._outline, color=OUTLINE, line_width=1.6)
            self._lines(one, panel, path)
            made.append(one)
        return made

    def _lines(self, one: Any, panel: tuple[Curve, ...], path: bool) -> None:
        now = []
        for k, curve in enumerate(panel):
            before = ColumnDataSource(_NOTHING, name=f"before {curve.name}")
            source = ColumnDataSource(_NOTHING, name=f"now {curve.name}")
            one.line("x", "y", source=before, color=REFERENCE, line_width=1.0, alpha=0.7)
            now.append((source, curve.name, COLOURS[k % len(COLOURS)]))
            self._before.append(before)
            self._now.append(source)
        drawn = [
            one.line("x", "y", source=source, color=colour, line_width=1.3, legend_label=name)
            for source, name, colour in now
        ]
        if not path:
            unit = printed_unit(panel[0].unit)
            tips = [("time", "@x{0.00000} s"), ("$name", f"@y{{0.0000}} {unit}")]
            for line, (_, name, _) in zip(drawn, now, strict=True):
                line.name = name
            one.add_tools(HoverTool(renderers=drawn, tooltips=tips, mode="vline"))
        one.legend.visible = len(panel) > 1
        one.add_layout(one.legend[0], "above")  # over no curve
        one.legend.orientation = "horizontal"
        one.legend.location = "left"
        one.legend.label_text_font_size = "12px"
        one.legend.padding = one.legend.margin = 3
        one.legend.background_fill_alpha = 0.0
        one.legend.border_line_color = None

    def _titles(self, curves: Curves) -> tuple[str, str, str]:
        first, second, third = (panel[0].name for panel in (curves.first, curves.second, curves.third))
        if self._is_path:
            first, second = "Path of the journal", "Normal forces"
        return first, second, third

    def _frame(self, reach: float) -> None:
        """Keep the whole play in view, as wide as high."""
        corner = _AROUND * reach
        self._corners.data = {"x": np.array([-corner, corner]), "y": np.array([-corner, corner])}


def _reach(panel: tuple[Curve, ...]) -> float:
    return max(float(np.abs(part).max(initial=0.0)) for curve in panel for part in (curve.x, curve.y))
