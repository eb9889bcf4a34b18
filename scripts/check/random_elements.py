#!/usr/bin/env python3
"""Random free-floating trees with random elements of all kinds: what is kept, and do the engines agree?

A tree of 2 to 5 links floats without gravity and is set going; each joint is dealt some of what a joint may
have besides play: stops, latches, dry friction, springs with hysteresis, harnesses, gears, racks and belts to
another joint, ball bearings, motors that sampled controllers command, controllers and motions that follow
references. Both engines run it at default tolerances. What must hold:

- the run completes, by both;
- linear and angular momentum stay, over the largest they are made of (``--momentum``), or else what they
  drift by is the steps' error and no element's: it falls with the tolerance, to a tenth or less where that
  is a hundredth;
- the ledger of energy closes, over the kinetic energy at the start (``--energy``);
- the engines come to the same changes of mode and the same configurations (``--apart``), or else no further
  apart than round-off grows in that motion: than ten times what one engine comes to by itself where the
  velocities it starts with are others in their last bits.

A line for each tree says what was found, and the verdict. Exit code 1 on any failure. Told to stop (Ctrl-C)
it sums up what it has; ``--first`` goes on from there.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from random_trees import Drawn, drawn

from antenna_pin import AntennaPinError, RunSettings

# How often a start is changed in its last bits; how much further apart engines may be, which round off at
# each step, than runs that differ at the start.
_TRIES, _GROWS = 3, 10.0
# A tolerance of which the steps' error is to fall so much: with order 8 it is proportional to it.
_TIGHTER, _FALLS = 0.01, 0.1


def _changes(data: Any) -> list[str]:
    """Return the changes of mode in order; those of one instant, whose order is round-off's, by name."""
    if "change" not in data:
        return []
    pairs = zip(data.change_time.values.tolist(), data.change.values.tolist(), strict=True)
    return [name for _, name in sorted(pairs)]


def _drift(run: Any) -> float:
    """Return by how much the momenta move, over the largest sum of sizes that they are made of."""
    found = 0.0
    for name, scale in (("linear", "momentum_scale"), ("angular", "angular_momentum_scale")):
        values = run.data[f"{name}_momentum"].values
        found = max(found, float(np.abs(values - values[0]).max() / run.data[scale].values.max()))
    return found


def _between(one: Any, other: Any) -> float:
    """Return by how much configurations of two runs differ at most, at the times of samples of both."""
    times = np.intersect1d(one.data.time.values, other.data.time.values)
    q = [run.data.q.values[np.searchsorted(run.data.time.values, times)] for run in (one, other)]
    return float(np.abs(q[0] - q[1]).max())


def _growth(tree: Drawn, run: Any, duration: float) -> float:
    """Return what one engine comes to by itself where its start differs in the last bits."""
    kept, grown = tree.v, 0.0
    for k in range(_TRIES):
        last_bits = np.random.default_rng(k).choice([-2.0, -1.0, 1.0, 2.0], len(kept))
        tree.v = kept * (1.0 + np.finfo(float).eps * last_bits)
        grown = max(grown, _between(run, tree.run("compiled", duration)))
    tree.v = kept
    return grown


@dataclass
class Told:
    """What was found of a tree."""

    # What the momenta drift by, by the engine of which that is more, over their largest.
    momentum: float = 0.0
    energy: float = 0.0  # what the ledger is open by, over the kinetic energy at the start
    apart: float = 0.0  # how far the engines' configurations are apart at most [rad] ([m])
    changes: int = 0  # how many changes of mode there were
    said: list[str] = field(default_factory=list)  # explanations of what is beyond a limit and no failure
    failed: list[str] = field(default_factory=list)  # what is one

    @property
    def verdict(self) -> str:
        """In words."""
        return "FAILED: " + ", ".join(self.failed) if self.failed else ", ".join(self.said) or "kept"


def told(tree: Drawn, duration: float, limits: argparse.Namespace) -> Told:
    """Return what is found of a tree, runs beside it included where a number is beyond its limit."""
    found = Told()
    runs = [tree.run(engine, duration) for engine in ("pinocchio", "compiled")]
    for run in runs:
        if not run.completed:
            found.failed.append(run.message)
            return found
        found.momentum = max(found.momentum, _drift(run))
        least = float(run.data.kinetic_energy.values[0])
        found.energy = max(found.energy, float(np.abs(run.data.energy_error).max()) / least)
    names = [_changes(run.data) for run in runs]
    found.apart, found.changes = _between(*runs), len(names[1])
    if found.energy > limits.energy:
        found.failed.append("ledger open")
    if found.momentum > limits.momentum:
        tight = _drift(tree.run("compiled", duration, rtol=_TIGHTER * RunSettings().rtol))
        kept = tight < _FALLS * found.momentum
        words = f"momentum: {tight:.1e} at {_TIGHTER:g} of the tolerance"
        (found.said if kept else found.failed).append(words + (", steps' error" if kept else ""))
    if found.apart > limits.apart or names[0] != names[1]:
        grown = _growth(tree, runs[1], duration)
        kept = found.apart <= _GROWS * grown
        words = f"apart: round-off grows to {grown:.1e}"
        if names[0] != names[1]:
            words += f", {len(names[0])} changes by one engine, {len(names[1])} by the other"
        (found.said if kept else found.failed).append(words)
    return found


def main() -> int:
    """Run them and tell of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="of trees [%(default)s]")
    parser.add_argument("--first", type=int, default=0, help="number of the first [%(default)s]")
    parser.add_argument("--seed", type=int, default=1, help="[%(default)s]")
    parser.add_argument("--only", type=int, action="append", help="one again")
    parser.add_argument("--duration", type=float, default=1.0, help="[s] [%(default)s]")
    parser.add_argument("--momentum", type=float, default=1e-9, help="relative [%(default)s]")
    parser.add_argument("--energy", type=float, default=1e-5, help="relative [%(default)s]")
    parser.add_argument("--apart", type=float, default=1e-9, help="[rad] or [m] [%(default)s]")
    asked = parser.parse_args()
    numbers = asked.only or range(asked.first, asked.count)
    all_told: list[Told] = []
    kinds: Counter[str] = Counter()
    try:
        for number in numbers:
            tree = drawn(asked.seed, number)
            try:
                found = told(tree, asked.duration, asked)
            except AntennaPinError as error:
                found = Told(failed=[" ".join(str(error).split())])
            all_told.append(found)
            kinds.update(tree.elements)
            print(
                f"{number:4d}  {len(tree.elements):2d} elements, {found.changes:3d} changes: momentum "
                f"{found.momentum:.1e}, energy {found.energy:.1e}, apart {found.apart:.1e}  {found.verdict}",
                flush=True,
            )
    except KeyboardInterrupt:
        print(f"stopped after {len(all_told)}")
    return _summed_up(all_told, kinds, asked)


def _summed_up(all_told: list[Told], kinds: Counter[str], limits: argparse.Namespace) -> int:
    """Say what all came to; return the exit code."""
    print("elements: " + ", ".join(f"{count} {name}" for name, count in sorted(kinds.items())))
    for name in ("momentum", "energy", "apart"):
        values, limit = np.array([getattr(one, name) for one in all_told] or [0.0]), getattr(limits, name)
        beyond = int((values > limit).sum())
        print(f"{name}: median {np.median(values):.1e}, worst {values.max():.1e}, beyond {limit:g}: {beyond}")
    failed = sum(bool(one.failed) for one in all_told)
    print(f"{len(all_told)} trees, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
