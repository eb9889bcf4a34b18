"""Drives, springs and forces in words: each knows its own."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np

from antenna_pin.analysis import drives_of
from antenna_pin.base.readable import readable
from antenna_pin.elements import FAMILIES, ForceElement, JointFriction
from antenna_pin.report._runs import ReportedRun
from antenna_pin.scenario import Scenario

__all__ = [
    "names_of_elements",
    "words_of_bearings",
    "words_of_elements",
    "words_of_forces",
    "words_of_friction",
]


def words_of_elements(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield each element of a scenario, with what it does."""
    for table, specs in scenario.families.items():
        for name, spec in specs.items():
            element: ForceElement = spec.build()
            text = element.words(getattr(spec, "motion", None) == "translation")
            if element.acts_at not in (None, name):
                text += f", at {element.acts_at}"
            clearance = scenario.clearance.get(element.acts_at or "")
            if (
                element.about in ("bearing", "journal")
                and clearance is not None
                and clearance.model != "ideal"
            ):
                text += f", about the {element.about}'s axis"
            yield f"{FAMILIES[table].word} {name}", text + _off(element)


def _off(element: ForceElement) -> str:
    return "" if element.acts else ", off at the start"


def words_of_bearings(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what bearings of a run carried."""
    for k, name in enumerate(run.names("bearing")):
        force, moment = (float(run.data[f"peak_bearing_{what}"][k]) for what in ("force", "moment"))
        yield (
            f"load of bearing {name}",
            f"at most {readable(force, 'N')} and {readable(moment, 'N m')} at a sample",
        )


def words_of_forces(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what forces on links have brought in."""
    for k, name in enumerate(run.names("force")):
        impulse, turning = (
            float(np.linalg.norm(run.data[f"total_{what}"].values[k]))
            for what in ("impulse", "angular_impulse")
        )
        work = float(run.data["total_force_work"][k])
        yield (
            f"impulse of force {name}",
            f"{readable(impulse, 'N s')} and {readable(turning, 'N m s')} about the world's origin, "
            f"work {readable(work, 'J')}",
        )


def words_of_friction(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the friction that joints of a run have of their own."""
    springs = () if run.run.scenario is None else run.run.scenario.springs
    for name, given in json.loads(run.data.attrs.get("joint_friction", "{}")).items():
        if name in springs:  # said there
            continue
        slides = given.pop("slides")
        yield f"friction of joint {given['joint']}", JointFriction(**given).words(slides)


def names_of_elements(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the names of drives, springs and forces of a system built in Python, and what else is told."""
    about = drives_of(run.run)
    for dimension, word in (("drive", "drives"), ("spring", "springs"), ("force", "forces")):
        if names := run.names(dimension):
            held = {name: "prescribed motion" for name in names if about.get(name, {}).get("motion")}
            yield (
                word,
                ", ".join(
                    f"{name} ({held[name]} of {about[name]['joint']})" if name in held else name
                    for name in names
                ),
            )
