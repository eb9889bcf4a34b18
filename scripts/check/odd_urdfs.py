#!/usr/bin/env python3
"""Random URDFs as exporters write them: do they load, and as the mechanisms that they mean?

``urdf_generator.py`` says what is odd about them. Each is loaded on a free base and compared with its plain
twin, which Pinocchio reads by itself: mass matrix and nonlinear effects at a random state must be the same
to the last bit, or to round-off where frames are added. The files stay in a folder, where ``antenna-pin urdf
FOLDER --check`` says what was passed over::

    scripts/check/odd_urdfs.py --count 200 --out odd

With ``--hands`` they are hands (``hand_generator.py``): fingers that mimic, knuckles without mass, inertia
that no body has. Each must load on a fixed base and have inertia to move by in its zero pose, but for one in
forty that is no mechanism.

Prints a line for each that does not load or is another mechanism, then the count beside that of Pinocchio
alone. With ``--slips`` each file has one name that is written almost right (``<orgin>``, ``xzy``) and must be
refused, in one line that names both; how many Pinocchio alone loads, as other mechanisms, is printed beside.
Exit code 1 on any.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from pathlib import Path

import numpy as np
import pinocchio as pin
from hand_generator import Hand, draw_hand
from urdf_generator import OddUrdf, SlippedUrdf, draw_slip, draw_urdf

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism
from antenna_pin.errors import NotSimulatedWarning

__all__ = ["problem_of", "problem_of_hand", "problem_of_slip"]

# Of the hands that Pinocchio loads, how many must load here: the others are no mechanisms.
_GOAL = 0.95
_GRAVITY = (0.0, 0.0, -9.81)


def problem_of(drawn: OddUrdf, path: Path) -> str | None:
    """Return how a URDF is not its plain twin; None if it is.

    Args:
        drawn: The URDF.
        path: The file with its bytes.
    """
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
    """Return how a URDF with a slip is not refused as it should be; None if it is.

    Args:
        drawn: The URDF.
    """
    try:
        Urdf.from_text(drawn.text, f"{drawn.name}.urdf")
    except AntennaPinError as error:
        said = str(error)
        if drawn.written in said and drawn.meant in said and "did you mean" in said:
            return None
        return f"is refused for something else: {said}"
    return "is not refused"


def main() -> int:
    """Draw, write, load and compare."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--slips", action="store_true")
    parser.add_argument("--hands", action="store_true")
    parser.add_argument("--out", type=Path, default=Path("odd_urdfs"), metavar="DIR")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    alone = failed = 0
    for number in range(given.count):
        if given.slips:
            slipped = draw_slip(given.seed, number)
            path, what = given.out / f"{slipped.name}.urdf", f"{slipped.written} for {slipped.meant}"
            path.write_text(slipped.text)
            problem = problem_of_slip(slipped)
        elif given.hands:
            hand = draw_hand(given.seed, number)
            path, what = (
                given.out / f"{hand.name}.urdf",
                "as it should" if not hand.moves else "it should load",
            )
            path.write_text(hand.text)
            problem = problem_of_hand(hand)
        else:
            drawn = draw_urdf(given.seed, number)
            path, what = given.out / f"{drawn.name}.urdf", ", ".join(drawn.oddities)
            path.write_bytes(drawn.odd)
            problem = problem_of(drawn, path)
        if problem:
            failed += 1
            print(f"{path}: {problem} ({what})")
        try:
            pin.buildModelFromUrdf(str(path))
            alone += 1
        except ValueError:
            pass
    if given.hands:
        share = (given.count - failed) / alone
        loaded = given.count - failed
        print(
            f"{loaded} of {given.count} load, {100 * share:.1f} % of the {alone} that Pinocchio alone loads"
        )
        return 1 if share < _GOAL else 0
    done = "are refused by their slips" if given.slips else "load as what they mean"
    print(f"{given.count - failed} of {given.count} {done}; Pinocchio alone loads {alone}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
