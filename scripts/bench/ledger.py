#!/usr/bin/env python3
"""Energy ledger: largest error of a run over the error that its tolerance explains; 1 raises the alarm.

Runs without loss for a long time (an oscillator, by each adaptive method), shipped cases, random scenarios at
the default tolerance and at a loose one, random trees with elements of all kinds.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from bench_tools import Report

from antenna_pin import System, Urdf, build_mechanism, list_scenarios, load_scenario, simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.elements import JointSpring

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "check"))
from random_trees import drawn  # noqa: E402
from scenario_generator import draw_scenario  # noqa: E402

METHODS = {"bogacki-shampine-32": 3, "dormand-prince-54": 5, "dormand-prince-853": 8}
ARM = """<robot name="arm"><link name="hull"/><link name="arm"><inertial><mass value="2"/>
<origin xyz="0.5 0 0"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>"""
STEPS = 600  # trial steps of a shipped case or a random scenario
LOOSE = 1e-5


def share(run: Any) -> float:
    """Return the ledger's error over what is explained."""
    kept = run.summary()["conservation"]
    return float(kept["energy_error"] / kept["energy_tolerance"])


def oscillators(method: Any) -> Iterable[Any]:
    """Run an arm on a spring for 30 periods, at small and large amplitudes and tolerances."""
    system = System(
        build_mechanism(Urdf.from_text(ARM, "arm"), base="fixed"),
        springs={"hinge": JointSpring(joint="hinge", stiffness=60.0)},
    )
    for rtol, angle in product((1e-8, LOOSE), (1e-6, 1e-3, 1.0)):
        settings = RunSettings(method=method, rtol=rtol, output_rate=20.0, ledger_alarm=False)
        yield simulate(system, duration=20.0, q=[math.cos(angle), math.sin(angle)], settings=settings)


def scenarios(drawn_ones: Iterable[Any], **changes: Any) -> Iterable[Any]:
    """Run scenarios for so many trial steps."""
    for one in drawn_ones:
        limits = {"integrator.max_steps": STEPS, "integrator.ledger_alarm": False}
        yield simulate(one.with_overrides({**limits, **changes}))


def shipped() -> Iterable[Any]:
    """Yield every shipped case, by adaptive steps."""
    for model in list_scenarios():
        for case in model.cases:
            one = load_scenario(model.name, case=case.name)
            if one.integrator.method != "rk4":
                yield one


def trees(count: int) -> Iterable[Any]:
    """Run random trees with elements of all kinds."""
    for number in range(count):
        yield drawn(1, number).run("compiled", 1.0, ledger_alarm=False)


def main() -> int:
    """Measure each kind."""
    report = Report("ledger", (__doc__ or "").partition("\n")[0])
    few = report.parse().quick
    random = [draw_scenario(7, number) for number in range(4 if few else 100)]
    kinds: dict[str, Callable[[], Iterable[Any]]] = {
        f"an oscillator over 20 s, order {order}": partial(oscillators, method)
        for method, order in METHODS.items()
    }
    kinds |= {
        "random scenarios": lambda: scenarios(random),
        "random scenarios, rtol 1e-5": lambda: scenarios(random, **{"integrator.rtol": LOOSE}),
        "random trees with elements": lambda: trees(4 if few else 100),
    }
    if not few:
        kinds["shipped cases"] = lambda: scenarios(shipped())
    for name, runs in kinds.items():
        report.add(name, max(map(share, runs())), limit=1.0)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
