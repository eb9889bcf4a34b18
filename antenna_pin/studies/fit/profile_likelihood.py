r"""Profile likelihoods: loss over one parameter held elsewhere, all others fitted anew.

Along a parameter the loss grows from its least, S, to S(x); with the variance phi of a weighted residual the
signed root

.. math:: \tau(x) = \mathrm{sign}(x - \hat x) \sqrt{(S(x) - S) / \phi}

is a straight line of slope one over the standard error where the model is linear; its bend shows how far
intervals by standard errors are off. The interval of the profile is where :math:`|\tau|` is below Student's
t; it need not lie evenly about the value, and may be open on a side.

References:
    Bates and Watts (1988), Nonlinear Regression Analysis and Its Applications, chapter 6.
    Raue and others (2009), Bioinformatics 25(15), 1923-1929: flat profiles and their meaning.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.readable import number, prefixed
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.studies.fit.uncertainty import DOUBT, Loss, Residuals, Sure, cost

_End = Literal["crossed", "bounded", "open", "stopped"]
"""How a side of an interval ends: where the loss is too high; at a bound of the parameter; nowhere, as far as
was looked; where the model cannot be run."""

# Change of the signed root in a step, over the threshold; most steps of a side.
_STEP, _MOST = 0.25, 40
# Largest ratio of consecutive steps.
_GROWTH = 3.0
# Distance in scales of the parameter from which a side without a rise is open.
_FAR = 100.0
# Relative tolerance of the crossing's root.
_NEAR = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Profile of one parameter."""

    name: str  # name of the parameter
    values: Array  # values at which it was held, rising, (n,), the best among them
    root: Array  # signed root tau of the growth of the loss, (n,) [-]
    others: Array  # all parameters there, (n, p)
    # lower end of the interval; minus infinity if open, the bound if bounded, the last value with a run if
    # stopped
    low: float
    high: float  # upper end, likewise
    ends: tuple[_End, _End]  # kinds of both ends
    threshold: float  # size of tau at the ends [-]
    # values of a lower loss than that of the fit, (p,), from which to fit again, or None
    better: Array | None


@takes()
def profiles(
    problem: Residuals,
    found: Sure,
    names: Sequence[str] | None = None,
    *,
    loss: Loss = "linear",
    loss_scale: float = 1.0,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[Profile, ...]:
    """Return the profiles of parameters, each with its interval.

    Args:
        problem: Problem of the fit.
        found: Uncertainty of its values: level, noise, and sizes of the first steps.
        names: Names of the parameters; all but those at a bound by default.
        loss: Loss of the fit.
        loss_scale: Residual from which the loss grows more slowly [-].
        progress: Called with the parameter and tau of each point.

    Raises:
        InvalidParameterError: The residuals have no noise.
        UnknownNameError: A parameter is unknown.
    """
    if not found.factor > 0.0:
        rule = (
            "given where the model meets the record exactly, because there are no "
            "residuals from which it follows"
        )
        raise InvalidParameterError("fit", "noise", rule, found.noise)
    wanted = [name for name, held in zip(found.names, found.held, strict=True) if not held]
    for name in names or ():
        if name not in found.names:
            raise UnknownNameError("fit", "parameter", name, found.names)
    made = []
    for name in wanted if names is None else names:
        path = _ProfilePath(problem, found, found.names.index(name), loss, loss_scale, progress)
        made.append(path.profile())
    return tuple(made)


class _ProfilePath:
    """Path of fits along one parameter."""

    def __init__(
        self,
        problem: Residuals,
        uncertainty: Sure,
        place: int,
        loss: Loss,
        loss_scale: float,
        progress: Callable[[str, float], None] | None,
    ) -> None:
        self._problem, self._found, self._place = problem, uncertainty, place
        self._loss, self._loss_scale, self._progress = loss, loss_scale, progress
        self._others = np.array(
            [k for k in range(len(uncertainty.names)) if k != place and problem.upper[k] > problem.lower[k]],
            dtype=int,
        )
        self._least = cost(problem.residuals(uncertainty.values), loss, loss_scale)
        # Growth of the loss at one standard error, squared.
        self._one = uncertainty.factor * float(uncertainty.stretch[place])
        self._better: Array | None = None
        self._best = self._least
        self._tangent = self._straight_on()

    def profile(self) -> Profile:
        """Return the whole profile."""
        below, first, low = self._side(-1.0)
        above, last, high = self._side(1.0)
        points = [*reversed(below), (0.0, self._found.values), *above]
        every = np.stack([one for _, one in points])
        return Profile(
            self._found.names[self._place],
            every[:, self._place],
            np.array([tau for tau, _ in points]),
            every,
            low,
            high,
            (first, last),
            self._found.quantile,
            self._better,
        )

    def _side(self, way: float) -> tuple[list[tuple[float, Array]], _End, float]:
        """Return tau and parameters along one side, its kind of end and place."""
        place, found, threshold = self._place, self._found, self._found.quantile
        centre = float(found.values[place])
        bound = float((self._problem.upper if way > 0.0 else self._problem.lower)[place])
        error = float(found.error[place])
        scale = float(self._problem.scale[place])
        step = _STEP * threshold * (error if math.isfinite(error) and error > 0.0 else scale)
        points: list[tuple[float, Array]] = [(0.0, found.values)]
        for _ in range(_MOST):
            last = points[-1]
            if last[1][place] == bound:
                return points[1:], "bounded", bound
            x = float(last[1][place]) + way * step
            x = min(x, bound) if way > 0.0 else max(x, bound)
            new = self._at(x, points)
            if new is None:
                return points[1:], "stopped", float(last[1][place])
            points.append(new)
            if abs(new[0]) >= threshold:
                end = self._crossed(points, way)
                return points[1:], "crossed", end
            grown = max(abs(new[0]) - abs(last[0]), 1e-3 * _STEP * threshold)
            if abs(x - centre) >= _FAR * max(scale, abs(centre)):
                break
            step *= min(_GROWTH, max(1.0 / _GROWTH, _STEP * threshold / grown))
            step = max(step, 1e-12 * max(abs(centre), scale))
        return points[1:], "open", way * math.inf

    def _crossed(self, points: list[tuple[float, Array]], way: float) -> float:
        """Return the crossing of tau's threshold, and insert its point."""
        place, threshold = self._place, self._found.quantile
        beyond = points.pop()
        inner, outer = points[-1], beyond
        for _ in range(30):
            share = (threshold - abs(inner[0])) / (abs(outer[0]) - abs(inner[0]))
            share = min(0.95, max(0.05, share))
            x = float(inner[1][place] + share * (outer[1][place] - inner[1][place]))
            new = self._at(x, [*points, beyond])
            if new is None:  # between two places where it runs
                break
            off = abs(new[0]) - threshold
            if abs(off) <= _NEAR * threshold or x in (inner[1][place], outer[1][place]):
                inner = new
                break
            inner, outer = (new, outer) if off < 0.0 else (inner, new)
        if inner is not points[-1]:
            points.append(inner)
        if inner is not beyond and abs(beyond[0]) <= 2.0 * threshold:
            points.append(beyond)
        if abs(inner[0]) == abs(outer[0]):
            return float(inner[1][place])
        rest = (threshold - abs(inner[0])) / (abs(outer[0]) - abs(inner[0]))
        return float(inner[1][place] + rest * (outer[1][place] - inner[1][place]))

    def _at(self, x: float, points: Sequence[tuple[float, Array]]) -> tuple[float, Array] | None:
        """Return tau and parameters with this parameter at x, or None."""
        place = self._place
        near = sorted(points, key=lambda one: abs(one[1][place] - x))[:2]
        slope = self._tangent
        if len(near) == 2 and near[0][1][place] != near[1][1][place]:
            slope = (near[0][1] - near[1][1]) / (near[0][1][place] - near[1][1][place])
        guess = near[0][1] + (x - near[0][1][place]) * slope
        guess[place] = x
        try:
            residuals = self._problem.residuals(guess)
            found = self._fitted(guess) if np.isfinite(residuals).all() else guess
            residuals = self._problem.residuals(found)
        except AntennaPinError:
            return None
        if not np.isfinite(residuals).all():
            return None
        size = cost(residuals, self._loss, self._loss_scale)
        if size < self._best - 1e-6 * self._one:
            self._best, self._better = size, found.copy()
        way = 1.0 if x >= self._found.values[place] else -1.0
        tau = way * math.sqrt(max(size - self._least, 0.0) / self._one)
        if self._progress is not None:
            self._progress(self._found.names[place], tau)
        return tau, found

    def _straight_on(self) -> Array:
        """Return the direction of the valley at the best values, (p,)."""
        jacobian, others = self._problem.jacobian(self._found.values), self._others
        slope = np.zeros(len(self._found.names))
        if len(others):
            scale = self._problem.scale[others]
            shift, *_ = np.linalg.lstsq(jacobian[:, others] * scale, -jacobian[:, self._place], rcond=DOUBT)
            slope[others] = shift * scale
        return slope

    def _fitted(self, guess: Array) -> Array:
        """Return the parameters of least loss with this parameter held."""
        if not len(self._others):
            return guess
        from scipy.optimize import least_squares

        others, problem = self._others, self._problem
        scale = problem.scale[others]
        lower, upper = problem.lower[others], problem.upper[others]

        def whole(part: Array) -> Array:
            values = guess.copy()
            values[others] = part * scale
            return values

        inside = np.clip(guess[others], lower, upper)  # a guess by extrapolation, no value of the user's
        span = np.where(np.isfinite(upper - lower), upper - lower, scale)
        inside = np.minimum(np.maximum(inside, lower + 1e-12 * span), upper - 1e-12 * span)

        def residuals(part: Array) -> Array:
            return problem.residuals(whole(part))

        def jacobian(part: Array) -> Array:
            return np.asarray(problem.jacobian(whole(part))[:, others] * scale)

        made: Any = least_squares(
            residuals,
            inside / scale,
            jac=jacobian,
            bounds=(lower / scale, upper / scale),
            loss=self._loss,
            f_scale=self._loss_scale,
            xtol=1e-8,
            ftol=1e-10,
            gtol=1e-12,
            max_nfev=60,
        )
        return whole(np.asarray(made.x))


# --- profiles as text ---------------------------------------------------------------------------------------

# Suffix of a side's end by kind; none for an open one.
_BEHIND = {"crossed": "", "bounded": ", its bound", "stopped": ", beyond which the model cannot be run"}
_SIDES = ("below", "above")


def profile_lines(table: xr.Dataset) -> list[str]:
    """Return a line for each parameter with a profile in a fit's table."""
    found = []
    for name in map(str, table["parameter"].values):
        said = profile_interval(table.sel(parameter=name))
        if said:
            found.append(f"{name}: by its profile {said} (95 %)")
    return found


def profile_interval(one: xr.Dataset) -> str:
    """Return the interval of one parameter's profile as text, or ""."""
    how = [str(word) for word in one["profile_how"].values]
    if not all(how):
        return ""
    value, unit = float(one["value"]), str(one["units"].item())
    ends = [float(end) for end in one["profile_end"].values]
    if how == ["crossed", "crossed"]:
        return f"from {interval_text(value, ends[0], ends[1], unit)}"
    said = [
        f"{text}{_BEHIND.get(word, '')}"
        for text, word in zip(_printed(value, ends, unit, each=True), how, strict=True)
    ]
    open_on = [side for side, word in zip(_SIDES, how, strict=True) if word == "open"]
    if len(open_on) == 2:
        return "any value: the records do not bound it, as far as was looked"
    if open_on:
        known, word = (said[0], "or more") if open_on == ["above"] else (said[1], "or less")
        return f"{known} {word}: {open_on[0]} the records do not bound it"
    return f"from {said[0]} to {said[1]}"


def interval_text(value: float, low: float, high: float, unit: str) -> str:
    """Return an interval with digits that suit its width: ``0.9 to 1.2 mm``."""
    return " to ".join(_printed(value, [low, high], unit, each=False))


def _printed(value: float, ends: list[float], unit: str, each: bool) -> list[str]:
    """Return ends in the value's unit, printed behind each or behind the last."""
    factor, printed = prefixed(unit or "1", [value])
    half = max((abs(end - value) for end in ends if math.isfinite(end)), default=0.0)
    digits = 3
    if half > 0.0 and value != 0.0:
        digits = min(12, 2 + max(0, math.floor(math.log10(abs(value) / half)) + 1))
    behind = f"\N{NO-BREAK SPACE}{printed}" if printed else ""
    texts = [number(factor * end, digits) if math.isfinite(end) else "" for end in ends]
    return [text + (behind if each or k == len(ends) - 1 else "") for k, text in enumerate(texts)]
