"""Runs that are killed and stopped at random and go on from checkpoints, and whether results are the same."""

import contextlib
import dataclasses
import signal

import numpy as np

from antenna_pin import Outcome, simulate


class KilledError(Exception):
    """What kills a run on its way."""


def in_pieces(scenario, span, out, rng, times, looks=60, checkpoint=0.02, **more):
    """Make a run that is stopped so often at random steps, and return its result.

    It is either killed, which loses what came after its last checkpoint, or asked to stop; at one of so many
    looks from where it goes on.
    """
    for _ in range(times):
        last, kill = int(rng.integers(1, looks)), rng.random() < 0.5
        seen = []

        def look(progress, seen=seen, last=last, kill=kill):
            seen.append(progress)
            if len(seen) == last:
                if kill:
                    raise KilledError
                # One that comes behind the last look comes again behind the run: not here.
                if progress.time < progress.end:
                    signal.raise_signal(signal.SIGINT)

        with contextlib.suppress(KilledError):
            found = simulate(
                scenario,
                duration=span,
                out=out,
                checkpoint=checkpoint,
                resume=is_stopped(out),
                progress=look,
                **more,
            )
            # What is asked to stop at its end has come there.
            stopped = len(seen) >= last and seen[last - 1].time < seen[last - 1].end
            assert found.outcome is (Outcome.INTERRUPTED if stopped else Outcome.COMPLETED)
            if found.completed:
                return found
    return simulate(scenario, duration=span, out=out, resume=is_stopped(out), **more)


def is_stopped(out):
    return out.with_name("run.nc.parts").joinpath("checkpoint").exists()


def same(one, other):
    """Whether two results are the same but for the time they took."""
    assert set(one.data.variables) == set(other.data.variables)
    for name in one.data.variables:
        a, b = one.data[name].values, other.data[name].values
        assert a.shape == b.shape, name
        assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), name
    for name in one.data.attrs.keys() - {"finished", "counts"}:
        assert one.data.attrs[name] == other.data.attrs[name], name
    for name in ("outcome", "message", "scenario", "end"):
        assert getattr(one, name) == getattr(other, name), name
    assert dataclasses.replace(one.counts, wall_seconds=0.0) == dataclasses.replace(
        other.counts, wall_seconds=0.0
    )
