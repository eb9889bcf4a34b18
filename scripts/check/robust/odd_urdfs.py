"""Random URDFs as exporters write them: each must load, as the mechanism that it means.

``urdf_generator.py`` says what is odd about them. Each is loaded on a free base and compared with its plain
twin, which Pinocchio reads by itself: mass matrix and nonlinear effects at a random state must be the same
to the last bit, or to round-off where frames are added. The files stay in a folder, where ``antenna-pin urdf
FOLDER --check`` says what was passed over::

    scripts/check/robustness.py odd-urdfs --count 200 --out odd

With ``--hands`` they are hands (``hand_generator.py``): fingers that mimic, knuckles without mass, inertia
that no body has. Each must load on a fixed base and have inertia to move by in its zero pose, but for one in
forty that is no mechanism.

Prints a line for each that does not load or is another mechanism, then the count beside that of Pinocchio
alone. With ``--slips`` each file has one name that is written almost right (``<orgin>``, ``xzy``) and must be
refused, in one line that names both; how many Pinocchio alone loads, as other mechanisms, is printed beside.
"""

from __future__ import annotations

import argparse
import contextlib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from hand_generator import Hand, draw_hand
from urdf_generator import OddUrdf, SlippedUrdf, draw_slip, draw_urdf

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism
from antenna_pin.errors import NotSimulatedWarning
from robust.trials import Report, write_files

SEED = 0
OPTIONS = {
    "--count": {"type": int, "default": 200, "help": "of URDFs [%(default)s]"},
    "--slips": {"dest": "kind", "action": "store_const", "const": "slips", "help": "with one slip each"},
    "--hands": {"dest": "kind", "action": "store_const", "const": "hands", "help": "that are hands"},
    "--out": {"type": Path, "default": Path("odd_urdfs"), "metavar": "DIR", "help": "[%(default)s]"},
}

# Of the hands that Pinocchio loads, how many must load here: the others are no mechanisms.
_GOAL = 0.95
_GRAVITY = (0.0, 0.0, -9.81)


def problem_of(drawn: OddUrdf, path: Path) -> str | None:
    """Return how a URDF, in a file, is not its plain twin; None if it is."""
    try:
        model = build_mechanism(Urdf.load(path), "free", _GRAVITY).model
    except AntennaPinError as error:
        return str(error)
    twin = pin.buildModelFromXML(drawn.plain, pin.JointModelFreeFlyer())
    if list(model.names) != list(twin.names):
        return f"has joints {', '.join(model.names)} for {', '.join(twin.names)}"
    rng = np.random.default_rng(len(drawn.odd))
    q = pin.integrate(twin, pin.neutral(twin), rng.normal(size=twin.nv))
    v = rng.normal(size=twin.nv)
    masses = [np.triu(pin.crba(one, one.createData(), q)) for one in (model, twin)]
    effects = [pin.nle(one, one.createData(), q, v) for one in (model, twin)]
    # Where a frame hangs on a link Pinocchio adds nothing to its inertia, by a sum that rounds.
    off = 1e-13 if "frames_of_no_mass" in drawn.oddities else 0.0
    for what, (odd, plain) in (("mass matrix", masses), ("nonlinear effects", effects)):
        if np.abs(odd - plain).max() > off * np.abs(plain).max():
            return f"{what} differ by {np.abs(odd - plain).max():.3g}"
    return None


def problem_of_hand(drawn: Hand) -> str | None:
    """Return why a hand does not load as a mechanism that moves from its zero pose; None if it does."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotSimulatedWarning)
            system = System(
                build_mechanism(Urdf.from_text(drawn.text, f"{drawn.name}.urdf"), "fixed", _GRAVITY)
            )
            system.check_pose(system.neutral()[: system.model.nq], "zero pose")
    except AntennaPinError as error:
        return str(error)
    return None


def problem_of_slip(drawn: SlippedUrdf) -> str | None:
    """Return how a URDF with a slip is not refused as it should be; None if it is."""
    try:
        Urdf.from_text(drawn.text, f"{drawn.name}.urdf")
    except AntennaPinError as error:
        said = str(error)
        if drawn.written in said and drawn.meant in said and "did you mean" in said:
            return None
        return f"is refused for something else: {said}"
    return "is not refused"


def drawn(seed: int, number: int, kind: str | None) -> tuple[Any, bytes | str, str, Callable[[Path], Any]]:
    """Return a URDF of a kind, its text, what is odd about it, and what returns its fault."""
    if kind == "slips":
        slip = draw_slip(seed, number)
        return slip, slip.text, f"{slip.written} for {slip.meant}", lambda path: problem_of_slip(slip)
    if kind == "hands":
        hand = draw_hand(seed, number)
        what = "it should load" if hand.moves else "as it should"
        return hand, hand.text, what, lambda path: problem_of_hand(hand)
    odd = draw_urdf(seed, number)
    return odd, odd.odd, ", ".join(odd.oddities), lambda path: problem_of(odd, path)


def run(given: argparse.Namespace, report: Report, folder: Path) -> int:
    """Draw, write, load and compare; return the exit code."""
    alone = failed = 0
    for number in range(given.count):
        urdf, text, what, check = drawn(given.seed, number, given.kind)
        path = given.out / f"{urdf.name}.urdf"
        write_files(given.out, {path.name: text})
        if problem := check(path):
            failed += 1
            print(f"{path}: {problem} ({what})")
        with contextlib.suppress(ValueError):
            pin.buildModelFromUrdf(str(path))
            alone += 1
    good = given.count - failed
    if given.kind == "hands":
        share = good / alone
        print(f"{good} of {given.count} load, {100 * share:.1f} % of the {alone} that Pinocchio alone loads")
        return int(share < _GOAL)
    done = "are refused by their slips" if given.kind == "slips" else "load as what they mean"
    print(f"{good} of {given.count} {done}; Pinocchio alone loads {alone}")
    return int(failed > 0)
