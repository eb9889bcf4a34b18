"""What moves the peak force of the satellite of You, Pan and Zhao (2010), and how much of it is chance."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from first_impact import first_impact
from you2010_runs import EXTERNAL, LAYOUTS, NO_FRICTION, PLAY, Load, run, scenario, settled

from antenna_pin import Trajectory, build_system, simulate
from antenna_pin.analysis import deviation, impacts

#: Of each row, where chance is looked at; the first is as it is.
RUNS = 11


def changes() -> dict[str, tuple[str, ...]]:
    """Return what is changed, one cause at a time: what is said of it, the entries."""
    play = "clearance.joint2"
    return {
        "as shipped": (),
        "tolerance 1e-8 -> 1e-11": ("integrator.rtol=1e-11",),
        "floor of approach speed 0.01 mm/s": (f"{play}.approach_speed_floor=1e-5",),
        "floor of approach speed 10 mm/s": (f"{play}.approach_speed_floor=1e-2",),
        "stiffness as printed": (EXTERNAL,),
        "stiffness x 10": (f"{play}.normal.stiffness=5.418e11",),
        "restitution 0.5": (f"{play}.normal.restitution=0.5",),
        "restitution 0.8": (f"{play}.normal.restitution=0.8",),
        "restitution 1": (f"{play}.normal.restitution=1.0",),
        "friction 0": (NO_FRICTION,),
        "friction 0.1": (f"{play}.friction.coefficient_of_friction=0.1",),
        "friction in full from 10 mm/s": (f"{play}.friction.upper_speed=10 mm/s",),
        "play 0.05 mm": (f"{play}.radial_clearance=0.05 mm", f"{play}.normal.stiffness=5.418e10"),
        "play 0.05 mm, its own stiffness": (f"{play}.radial_clearance=0.05 mm",),
        "play 0.05 mm, friction 0": (
            f"{play}.radial_clearance=0.05 mm",
            f"{play}.normal.stiffness=5.418e10",
            NO_FRICTION,
        ),
        "play 0.1 mm": (f"{play}.radial_clearance=0.1 mm", f"{play}.normal.stiffness=5.418e10"),
        "play 1 mm": (f"{play}.radial_clearance=1 mm", f"{play}.normal.stiffness=5.418e10"),
        "journal half way to its seat": ("0.5",),
        "journal on its seat": ("1",),
        "joint 1 at the body's mass centre": ("mechanism.joints.joint1.origin_xyz=[0, 0, 0]",),
        "shaft 1's moments 0.1, 1, 1": ("mechanism.links.shaft1.inertia=[0.1, 1, 1]",),
        "body's moments as printed": (
            "mechanism.allow_impossible_inertia=['body']",
            "mechanism.links.body.inertia=[1000, 100, 100]",
        ),
    }


def causes_part(quick: bool) -> None:
    """Print what moves the peak force, one change at a time."""
    for case, ideal in LAYOUTS.items():
        span = 0.1 if quick else 2.0 if case == "planar" else 5.0
        rows = []
        for label, overrides in changes().items():
            if overrides and overrides[0] in ("0.5", "1"):
                overrides = (_seat(case, float(overrides[0])),)
            with_play = run(case, *overrides, span=span)
            table = impacts(with_play)
            held = Load.of(run(ideal, *(o for o in overrides if o.startswith("mechanism")), span=span))
            loads = Load.of(with_play)
            largest = loads.largest(0.0, span)
            speed, force = (abs(float(table[name][0])) for name in ("approach_speed", "peak_force"))
            rows.append(
                f"{label:34} {1e3 * speed:8.3g} {force:9.4g}"
                f" {largest:9.4g} {loads.time[loads.force.argmax()]:7.3f} {held.largest(0.0, span):8.4g}"
                f" {largest / held.largest(0.0, span):7.3g} {settled(with_play):8.3g}"
            )
        print(f"{case}, {span:g} s")
        for head in (
            ("", "approach", "first", "largest", "at", "ideal", "ratio", "lasting"),
            ("", "mm/s", "N", "N", "s", "N", "-", "from s"),
        ):
            print("{:34} {:>8} {:>9} {:>9} {:>7} {:>8} {:>7} {:>8}".format(*head))
        print("\n".join(rows))


def chance_part(quick: bool) -> None:
    """Print how much of the planar layout's numbers repeats if the play changes by less than can be measured.

    The first run of a row is as it is; the others have a play that is off by up to 5e-13 of itself, about
    what another order of sums does to a run.
    """
    span = 0.1 if quick else 2.0
    print(f"{f'planar, {RUNS} runs a row':40}  as it is     least    median      most")
    for label, overrides in changes().items():
        if overrides and overrides[0] in ("0.5", "1"):
            overrides = (_seat("planar", float(overrides[0])),)
        found = [Load.of(one).largest(0.0, span) for one in _near(overrides, span)]
        _say(f"{label}: N", found)
    span = 0.1 if quick else 5.0
    ideal = run("ideal", span=span)
    for label, overrides in (("0.25", ()), ("0", (NO_FRICTION,))):
        found = [1e3 * deviation(one, ideal)["joint2 angle"].maximum for one in _near(overrides, span)]
        _say(f"friction {label}, {span:g} s, off: mrad", found)


def _near(overrides: tuple[str, ...], span: float) -> Iterator[Trajectory]:
    """Yield the run of some changes, and runs beside it."""
    play = scenario("planar", *overrides).clearance["joint2"].radial_play
    yield simulate(scenario("planar", *overrides), duration=span)
    for k in range(1, RUNS):
        off = 1e-13 * (k // 2 + k % 2) * (1 if k % 2 else -1)
        yield simulate(scenario("planar", *overrides, f"{PLAY}={play * (1.0 + off)!r}"), duration=span)


def _say(label: str, found: list[float]) -> None:
    """Print a row of numbers: the first, the least, the middle one, the largest."""
    numbers = (found[0], *np.quantile(found, (0.0, 0.5, 1.0)))
    print(f"{label:40}" + "".join(f"{number:10.4g}" for number in numbers), flush=True)


def _seat(case: str, share: float) -> str:
    """Return where the journal starts if it is moved to where the ideal joint's force presses it."""
    system = build_system(scenario(case))
    (joint,) = system.clearances
    spec = scenario(case).clearance["joint2"]
    force = first_impact(system, spec.radial_play, joint.radial.stiffness, 0.95).ideal_force
    # The bearing pushes the journal along the force, so the journal sits on the other side.
    x, y = -share * spec.radial_play * force / np.linalg.norm(force)
    return f"initial.joints.joint2.journal_position=[{x:.17g}, {y:.17g}, 0]"
