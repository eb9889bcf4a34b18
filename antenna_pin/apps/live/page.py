"""Page of the explorer: sliders, figures, and their interaction."""

from __future__ import annotations

import itertools
import json
import time
from collections.abc import Callable
from functools import partial
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.models import (
    BasicTickFormatter,
    Button,
    Column,
    ColumnDataSource,
    CustomJS,
    Div,
    HoverTool,
    Row,
    Select,
    Slider,
    TextInput,
)
from bokeh.plotting import figure
from jinja2 import Environment, Template

from antenna_pin.apps.live.explored import Curve, Curves, Explored, said_of
from antenna_pin.apps.live.knobs import Knob
from antenna_pin.apps.live.runner import COMPILING, Runner, RunUpdate
from antenna_pin.base.readable import lasting, prefixed, printed_unit
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario import Scenario

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


_POSITIONS = 200  # of a slider
_TICK = 250  # between two looks at the stage of the first run [ms]


class ExplorerPage:
    """Page as shown by one browser.

    Args:
        document: What it is written into.
        scenario: Where it starts from.
        joint: Joint shown first.
        span: How much of the run is made [s].
        out: Where the scenario is saved: a file, or a folder for numbered ones.
        tell: Called with the stages of the first run.
    """

    def __init__(
        self,
        document: Document,
        scenario: Scenario,
        joint: str | None,
        span: float,
        out: Path,
        tell: Callable[[str], None],
    ) -> None:
        """Build the page, and request the first run."""
        self._document, self._out, self._tell = document, out, tell
        self._stage = ""
        self._explored = Explored(scenario, joint, span)
        self._name = "-".join(filter(None, (scenario.name, scenario.case)))
        self._runner = Runner(self._pass_on)
        self._panels = Panels()
        self._status = dressed(Div(name="status", sizing_mode="stretch_width"))
        self._knobs = Column(name="knobs", sizing_mode="stretch_width")
        self._setting = False
        self._shown: Curves | None = None
        self._reference: Curves | None = None
        self._said, self._times = "", 0
        self._make_knobs()
        document.template = _template()
        document.title = f"{self._name} \N{EN DASH} antenna_pin explore"
        document.template_variables.update(heading=scenario.title or self._name, about=_about(scenario))
        for root in (self._knobs, *self._panels.columns, self._status):
            document.add_root(root)
        dark = darkened(self._panels.columns)
        document.js_on_event("document_ready", dark)
        for column in self._panels.columns:
            column.js_on_change("children", dark)
        document.on_session_destroyed(lambda context: self._runner.close())
        self._opened = time.perf_counter()
        self._ticking: Any = document.add_periodic_callback(self._tick, _TICK)
        self._tick()
        self._ask()

    # --- the numbers ----------------------------------------------------------------------------------------

    def _make_knobs(self) -> None:
        explored = self._explored
        joint = Select(title="Joint", options=explored.joints, value=explored.joint, name="joint")
        joint.sizing_mode = "stretch_width"
        joint.on_change("value", self._look_at)
        buttons = []
        for name, title, kind, does in (
            ("save", "Save as scenario", "primary", self._save),
            ("keep", "Compare with this", "default", self._keep),
            ("reset", "Reset", "default", self._reset),
        ):
            button = Button(label=title, name=name, button_type=kind, sizing_mode="stretch_width")
            button.on_click(does)
            buttons.append(dressed(button))
        rows = [Row(*some, sizing_mode="stretch_width") for some in (buttons[:1], buttons[1:])]
        shown: list[Any] = [dressed(joint), *rows]
        self._sliders: dict[str, tuple[Knob, Slider, TextInput]] = {}
        for group, knobs in itertools.groupby(explored.knobs, key=lambda knob: knob.group):
            shown.append(dressed(Div(text=f"<h2>{escape(group)}</h2>", sizing_mode="stretch_width")))
            shown += [self._knob(knob) for knob in knobs]
        self._knobs.children = shown

    def _knob(self, knob: Knob) -> Row:
        value = self._explored.value(knob)
        slider = Slider(
            start=0.0,
            end=1.0,
            step=1.0 / _POSITIONS,
            value=knob.to_slider(value),
            title=knob.name,
            show_value=False,
            name=knob.place,
            sizing_mode="stretch_width",
        )
        typed = TextInput(
            value=knob.display_text(value), width=104, margin=(14, 5, 0, 5), name=f"{knob.place} typed"
        )
        self._sliders[knob.place] = knob, slider, typed
        slider.on_change("value", partial(self._slid, knob))
        typed.on_change("value", partial(self._typed, knob))
        return Row(dressed(slider), dressed(typed), sizing_mode="stretch_width")

    def _slid(self, knob: Knob, attribute: str, old: float, new: float) -> None:
        if not self._setting:
            self._turn(knob, knob.from_slider(new), slide=False)

    def _typed(self, knob: Knob, attribute: str, old: str, new: str) -> None:
        if self._setting:
            return
        try:
            value = knob.read(new)
        except AntennaPinError as error:
            self._say(refused=str(error))
        else:
            self._turn(knob, value, slide=True)

    def _turn(self, knob: Knob, value: float, *, slide: bool) -> None:
        self._explored.turn(knob.place, value)
        self._set(knob, value, slide=slide)
        self._ask()

    def _set(self, knob: Knob, value: float, *, slide: bool) -> None:
        """Let the widgets of a knob show its value, without hearing it from them."""
        _, slider, typed = self._sliders[knob.place]
        self._setting = True
        try:
            typed.value = knob.display_text(value)
            if slide:
                slider.value = knob.to_slider(value)
        finally:
            self._setting = False

    def _look_at(self, attribute: str, old: str, new: str) -> None:
        self._explored.look_at(new)
        self._reference = None
        self._panels.forget()
        self._make_knobs()
        self._ask()

    def _reset(self) -> None:
        self._explored.reset()
        for knob, _, _ in self._sliders.values():
            self._set(knob, knob.value, slide=True)
        self._ask()

    def _keep(self) -> None:
        self._reference = self._shown
        if self._shown is not None:
            self._panels.show(self._shown, self._reference)

    def _save(self) -> None:
        target = self._out
        if target.is_dir():
            names = (
                f"{self._name}-explored{f'-{k}' if k else ''}.toml".replace("/", "-")
                for k in itertools.count()
            )
            target = next(path for path in (self._out / name for name in names) if not path.exists())
        try:
            self._explored.save(target)
        except (AntennaPinError, OSError) as error:
            self._say(refused=str(error))
        else:
            self._say(note=f"saved {target}; antenna-pin run {target} makes this run")

    # --- the run --------------------------------------------------------------------------------------------

    def _ask(self) -> None:
        self._runner.ask(self._explored.scenario)

    def _pass_on(self, answer: RunUpdate) -> None:
        """Pass a run from its thread to the page's own."""
        self._document.add_next_tick_callback(partial(self._show, answer))

    def _tick(self) -> None:
        """Write the stage of the first run until its first display."""
        seconds, stage = round(time.perf_counter() - self._opened), self._runner.stage
        self._panels.announce(f"<div role='status'>First run: {escape(stage)} ({seconds} s)</div>")
        if stage == COMPILING != self._stage:
            self._stage = stage
            self._tell(f"first run: {stage}")

    def _show(self, answer: RunUpdate) -> None:
        if self._ticking is not None:
            self._document.remove_periodic_callback(self._ticking)
            self._ticking = None
            self._panels.announce("")
            shown = f"shown after {lasting(time.perf_counter() - self._opened)}"
            self._tell(f"first run: {answer.refused or shown}")
        if answer.run is None:
            self._say(refused=answer.refused)
            return
        curves = self._explored.curves(answer.run)
        if answer.done and self._reference is None:
            self._reference = curves
        self._shown = curves
        self._document.hold("combine")  # one message, one picture
        self._panels.show(curves, self._reference)
        ended, lines = said_of(answer.run)
        about = (
            f"{ended}; here {lasting(answer.wall)} after the change"
            if answer.done
            else f"on its way: {self._runner.stage} \N{HORIZONTAL ELLIPSIS}"
        )
        told = "".join(
            f"<div><span class='about'>{escape(line.about)}</span> {escape(line.text)}</div>"
            for line in lines
        )
        self._said = f"{told}<div class='soft'>{escape(about)}</div>"
        self._say()
        self._document.unhold()

    def _say(self, *, refused: str = "", note: str = "") -> None:
        first = f"<div class='refused' role='alert'>{escape(refused)}</div>" if refused else ""
        first += f"<div role='status'><b>{escape(note)}</b></div>" if note else ""
        self._status.text = first + self._said
        self._times += 1
        self._status.tags = [self._times]  # for those who wait for it


def _template() -> Template:
    text = files("antenna_pin.apps.live").joinpath("page.html").read_text(encoding="utf-8")
    return Environment(autoescape=False).from_string(text)


def _about(scenario: Scenario) -> str:
    words = [f"case {scenario.case}" if scenario.case else "", scenario.description]
    return ": ".join(filter(None, words))
