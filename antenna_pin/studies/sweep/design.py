"""Design of a study: a grid of lists and ranges, times random samples."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import MOST
from antenna_pin.base.units import shown
from antenna_pin.errors import ScenarioError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import key_parts
from antenna_pin.scenario.parameters import Settings
from antenna_pin.studies.sweep.study import SamplingSpec, Study

SAMPLE = "sample"
_LONGEST = 60  # characters of a value in a message
_INDEXED = re.compile(r"(.*)\[([0-9]{1,9})\]")


@dataclass(frozen=True, slots=True)
class ParameterColumn:
    """Values of one parameter along a dimension of the design."""

    name: str  # of the parameter
    keys: tuple[str, ...]  # of the scenario
    dim: str  # dimension along which the values run
    settings: Settings  # the values
    title: str  # in figures


@dataclass(frozen=True, slots=True)
class Design:
    """All runs of a study, numbered through its dimensions, the last one fastest."""

    sizes: dict[str, int]  # sizes of the dimensions, by name: those of the grid, then ``sample``
    columns: tuple[ParameterColumn, ...]  # the parameters
    # cumulative probability of each sample in its distribution, (sample, factor) [-]; or None
    probability: NDArray[np.float64] | None
    factors: tuple[str, ...]  # names of the sampled parameters
    seeds: NDArray[np.int64]  # seed of each run, (runs,) [-]

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the dimensions."""
        return tuple(self.sizes.values())

    @property
    def count(self) -> int:
        """Number of runs."""
        return int(np.prod(self.shape, dtype=np.int64))

    def place(self, run: int) -> dict[str, int]:
        """Return the indices of a run, by dimension."""
        return dict(zip(self.sizes, map(int, np.unravel_index(run, self.shape)), strict=True))

    def values(self, run: int) -> dict[str, Any]:
        """Return the settings of a run, by parameter."""
        place = self.place(run)
        return {column.name: column.settings.values[place[column.dim]].set for column in self.columns}

    def overrides(self, run: int, base: Scenario, only: tuple[str, ...] | None = None) -> dict[str, Any]:
        """Return the overrides of a run over the scenario, of all parameters or ``only`` some."""
        values, found = self.values(run), dict[str, Any]()
        for column in self.columns:
            if only is None or column.name in only:
                for key in column.keys:
                    put_value(found, key, values[column.name], base)
        return found

    def label(self, run: int) -> str:
        """Return a run's number and its values as text."""
        place = self.place(run)
        texts = [f"{c.name} = {_short(c.settings.values[place[c.dim]].text)}" for c in self.columns]
        return f"run {run} ({', '.join(texts)})"


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def put_value(overrides: dict[str, Any], key: str, value: Any, base: Scenario) -> None:
    """Enter the value of a key, as ``name`` or ``name[2]``, among a scenario's overrides.

    Raises:
        ScenarioError: The scenario has no such array, or the array no such number.
    """
    indexed = _INDEXED.fullmatch(key)
    if indexed is None:
        overrides[key] = value
        return
    name, index = indexed[1], int(indexed[2])
    array = overrides.get(name)
    if array is None:
        below: Any = base.model_dump()
        for part in key_parts(name):
            below = below.get(part) if isinstance(below, dict) else None
        array = below
    if not isinstance(array, list | tuple):
        raise ScenarioError(f"{key}: must be a number of an array of the scenario, got {shown(array)}")
    if index >= len(array):
        raise ScenarioError(f"{key}: must be one of {len(array)} numbers, from [0] on, got [{index}]")
    overrides[name] = [value if i == index else old for i, old in enumerate(array)]


@takes()
def design_of(study: Study) -> Design:
    """Return the runs of a study.

    Raises:
        ScenarioError: The runs are too many, or samples are not finite.
    """
    _check_count(study)
    sizes: dict[str, int] = {}
    columns: list[ParameterColumn] = []
    sampled = {name: one for name, one in study.parameters.items() if one.sampled}
    probability = None
    if sampled:
        assert study.sampling is not None
        probability = _probabilities(study.sampling, list(sampled), study.seed)
    for name, parameter in study.parameters.items():
        if parameter.sampled:
            assert probability is not None
            settings = parameter.drawn(probability[:, list(sampled).index(name)])
            for value in settings.values:
                if not np.isfinite(value.number):
                    raise ScenarioError(
                        f"study {study.name}: parameters.{name} must be bounded for the method "
                        f"{study.sampling.method if study.sampling else ''}, which needs its ends, got "
                        f"{value.number}; use a distribution with limits"
                    )
            dim = SAMPLE
        else:
            settings, dim = parameter.settings(), parameter.zip or name
            sizes[dim] = len(settings.values)
        columns.append(ParameterColumn(name, parameter.keys_set, dim, settings, parameter.title or name))
    if probability is not None:
        sizes[SAMPLE] = len(probability)
    count = math.prod(sizes.values())
    if count > MOST:
        raise _too_many(study, count)
    return Design(sizes, tuple(columns), probability, tuple(sampled), _seeds(study.seed, count))


def _check_count(study: Study) -> None:
    """Refuse a grid of too many runs before its values are made."""
    sizes = {one.zip or name: one.length for name, one in study.parameters.items() if not one.sampled}
    if math.prod(sizes.values()) > MOST:
        raise _too_many(study, math.prod(sizes.values()))


def _too_many(study: Study, count: int) -> ScenarioError:
    return ScenarioError(f"study {study.name}: must be of at most {MOST} runs, got {count}")


def _seeds(seed: int, count: int) -> NDArray[np.int64]:
    """Return a seed for each run, from streams that do not overlap."""
    children = np.random.SeedSequence([seed, 1]).spawn(count)
    seeds = (int(child.generate_state(1, np.uint64)[0]) >> 1 for child in children)
    return np.fromiter(seeds, dtype=np.int64, count=count)


def _probabilities(sampling: SamplingSpec, names: list[str], seed: int) -> NDArray[np.float64]:
    """Return points in the unit cube, (samples, factors)."""
    generator = np.random.default_rng(np.random.SeedSequence([seed, 0]))
    factors, count = len(names), sampling.count
    if sampling.method == "random":
        return generator.random((count, factors))
    from scipy.stats import qmc

    if sampling.method == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(factors, rng=generator).random(count))
    if sampling.method == "sobol":
        return np.asarray(qmc.Sobol(factors, scramble=True, rng=generator).random(count))
    from antenna_pin.studies.sweep.sensitivity import morris_points, saltelli_points

    number = int(generator.integers(2**31))
    if sampling.method == "morris":
        return morris_points(names, count, sampling.levels, number)
    return saltelli_points(names, count, sampling.second_order, number)
