"""Short runs of every kind that a report may be about, and a reader of its tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lxml.html
import pytest

from antenna_pin import (
    ClearanceJoint,
    Outcome,
    System,
    Trajectory,
    Urdf,
    build_mechanism,
    load_scenario,
    models_path,
    simulate,
)
from antenna_pin.contact import LankaraniNikravesh
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.show.report import Report, report


def run_of(case: str, duration: float = 0.1, *overrides: str) -> Trajectory:
    return simulate(load_scenario("bai2020", case=case, overrides=[f"duration={duration!r}", *overrides]))


@pytest.fixture(scope="session")
def ideal() -> Trajectory:
    return run_of("case1")


@pytest.fixture(scope="session")
def play() -> Trajectory:
    """With play: some tens of impacts."""
    return run_of("case3")


@pytest.fixture(scope="session")
def whole(
    ideal: Trajectory, play: Trajectory, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Report, Path]:
    """The report of both with all that it has, and its file: seconds to make."""
    made = report([ideal, play])
    return made, made.save(tmp_path_factory.mktemp("report") / "a report.html")


@pytest.fixture(scope="session")
def fixed() -> Trajectory:
    """A fixed base, gravity, a spring, a joint that keeps its plane, no drive."""
    return simulate(load_scenario("pendulum", case="planar"), duration=0.1)


@pytest.fixture(scope="session")
def from_python() -> Trajectory:
    """A system without a scenario."""
    urdf = Urdf.load(models_path() / "pendulum" / "pendulum.urdf")
    joint = next(joint.name for joint in urdf.robot.joints if joint.type in ("revolute", "continuous"))
    law = LankaraniNikravesh(stiffness=1e9, restitution=0.8)
    hinge = ClearanceJoint(
        name=joint,
        geometry=PlanarClearance(bearing_radius=10e-3, journal_radius=9.8e-3),
        radial=law,
    )
    mechanism = build_mechanism(urdf.variant(joints={joint: "planar"}), "fixed", (0.0, 0.0, -9.81))
    return simulate(System(mechanism, clearances=[hinge]), duration=0.05)


@pytest.fixture(scope="session")
def single(play: Trajectory) -> Trajectory:
    """One sample: stopped before the first step."""
    start = play.data.isel(time=[0], episode=slice(0, 0))
    return dataclasses.replace(
        play,
        data=start,
        outcome=Outcome.INTERRUPTED,
        message="stopped by the user; the results so far are saved",
    )


class Shown:
    """A report's page as it is written: tables by their key, texts."""

    def __init__(self, html: str) -> None:
        self.tree: Any = lxml.html.document_fromstring(html)

    def text(self, path: str = "//body") -> str:
        """Return the text of the elements at an XPath."""
        return " ".join(" ".join(part.text_content().split()) for part in self.tree.xpath(path))

    def said(self, section: str) -> dict[str, str]:
        """Return the statements of a section by label."""
        labels = self.tree.xpath(
            f"//section[@id='{section}']/dl/dt | //section[@id='{section}']/details/dl/dt"
        )
        return {label.text_content(): " ".join(label.getnext().text_content().split()) for label in labels}

    def rows(self, key: str) -> dict[str, list[tuple[str, float | None, str]]]:
        """Return a table: by group and name of the row, the text, number and unit of each cell."""
        (table,) = self.tree.xpath(f"//figure[@id='table-{key}']")
        group, found = "", {}
        for row in table.xpath(".//tbody/tr"):
            cells = row.xpath("./td")
            head = " ".join(row.xpath("./th")[0].text_content().split())
            if not cells:
                group = f"{head}: "
                continue
            name, _, unit = head.partition(" [")
            found[group + name] = [
                (
                    cell.text_content(),
                    float(value) if (value := cell.get("data-value")) else None,
                    unit.rstrip("]"),
                )
                for cell in cells
            ]
        return found

    def lines(self, key: str) -> dict[str, dict[str, float | None]]:
        """Return a table of many alike things: by the name of a line, the number under each quantity."""
        (table,) = self.tree.xpath(f"//figure[@id='table-{key}']")
        heads = [" ".join(one.text_content().split()) for one in table.xpath(".//thead//th")][1:]
        names = [head.partition(" [")[0] for head in heads]
        return {
            name: dict(zip(names, (value for _, value, _ in cells), strict=True))
            for name, cells in self.rows(key).items()
        }

    def numbers(self, key: str, row: str) -> list[float | None]:
        """Return the numbers behind a row, in SI units."""
        return [value for _, value, _ in self.rows(key)[row]]


@pytest.fixture(scope="session")
def shown() -> Callable[[str], Shown]:
    return Shown


@pytest.fixture
def check_width(page: Any) -> Callable[[Path, int, int, bool], None]:
    """Return a function that fails where an opened file, all of it unfolded, is wider than its screen."""

    def check(file: Path, width: int, height: int, mobile: bool) -> None:
        page.open(file, width, height)
        page.resize(width, height, mobile)
        page.run("document.querySelectorAll('details').forEach((part) => { part.open = true; });")
        wide, outside = page.run(
            "const scrolled = (e) => e.closest('.scroll, .source, .sheet, .ap-frame');"
            "const out = [...document.querySelectorAll('main *')].filter((e) => !scrolled(e) && "
            "e.getBoundingClientRect().right > innerWidth + 0.5);"
            "return [document.documentElement.scrollWidth, out.map((e) => e.outerHTML.slice(0, 80))];"
        )
        assert outside == [] and wide <= width
        assert page.errors == [] and page.requests == []

    return check
