#!/usr/bin/env python3
"""How long after a slider has moved the page of ``antenna-pin explore`` shows the new run, in a real browser.

A change is made in the page as a slider makes it; its time ends with the picture after the curves of all of
the run, 0.5 s of the antenna, have come. Dragged: twenty changes 30 ms apart, and the time is the last one's.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from bench_tools import Report

from antenna_pin import load_scenario
from antenna_pin.apps.live import Explored, explore
from antenna_pin.run.session import start
from antenna_pin.show.record.browser import open_browser

LONGEST = 300.0  # [ms]

READY = """
for (let k = 0; k < 1200; k++) {
  const status = window.Bokeh?.documents[0]?.get_model_by_name('status');
  if (status?.text.includes('after the change')) break;
  await new Promise((done) => setTimeout(done, 50));
}
"""
MOVE = """
const page = Bokeh.documents[0];
const [slider, status] = [page.get_model_by_name(a[0]), page.get_model_by_name('status')];
const began = performance.now();
const shown = new Promise((done) => {
  const heard = () => {
    if (!status.text.includes('after the change')) return;
    status.properties.text.change.disconnect(heard);
    requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now())));
  };
  status.properties.text.change.connect(heard);
});
let last = began;
for (const value of a[1]) {
  last = performance.now();
  slider.value = value;
  if (a[1].length > 1) await new Promise((done) => setTimeout(done, 30));
}
return (await shown) - last;
"""


def main() -> int:
    """Take the times."""
    report = Report("explore", __doc__ or "")
    changes = 5 if report.parse().quick else 20
    loaded = load_scenario("bai2020", case="case3")
    explored = Explored(loaded)
    knob = explored.knobs[0]
    places = [knob.to_slider(knob.value) + 0.005 * (k % 9 + 1) for k in range(changes)]
    own = []
    for place in places:
        explored.turn(knob.place, knob.from_slider(place))
        began = time.perf_counter()
        session = start(explored.scenario())
        session.run_until(explored.scenario().duration)
        session.trajectory()
        own.append(1e3 * (time.perf_counter() - began))
    with explore(loaded) as served, open_browser(here=True) as browser:
        browser.resize(1400, 900)
        browser.open(served.url)
        browser.run(READY)
        times = [browser.run(MOVE, knob.place, [place]) for place in [0.4, *places]]
        dragged = browser.run(MOVE, knob.place, [0.5 + 0.005 * k for k in range(20)])
    report.add("change to picture, median", float(np.median(times[1:])), "ms", LONGEST)
    report.add("change to picture, largest", float(np.max(times[1:])), "ms")
    report.add("last change of a drag to picture", dragged, "ms", LONGEST)
    report.add("the run alone, median", float(np.median(own[1:])), "ms")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
