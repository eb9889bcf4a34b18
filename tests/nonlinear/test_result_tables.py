"""Orbits, branches of them and exponents as files: what was found comes back, and can be gone on from."""

import json
import math
import re

import numpy as np
import pytest

from antenna_pin.analysis import stability_spans, unexplained_changes
from antenna_pin.base.state import State
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.studies.nonlinear import (
    amplitudes,
    branch_table,
    continued,
    exponents_table,
    family_of,
    flow_of,
    largest_exponent,
    open_branch,
    open_diagram,
    open_exponents,
    open_orbit,
    orbit_table,
    periodic_orbit,
    save_table,
)
from antenna_pin.trajectory import FORMATS, library_versions
from antenna_pin.trajectory.table import TABLES, problem_of_table

# A mass of 1 kg on 40 N/m and 1 N s/m, driven by 3 N at 0.8 Hz: all of it in closed form.
K, C, FORCE, FREQUENCY = 40.0, 1.0, 3.0, 0.8
DRIVEN = f"""
[springs.way]
stiffness = {K}
damping = {C}
[drives.motor]
joint = "way"
kind = "sine"
amplitude = {FORCE}
frequency = {FREQUENCY}
"""


@pytest.fixture
def driven(rig):
    return rig(DRIVEN)


def test_an_orbit_comes_back_from_its_file(driven, tmp_path):
    period = 1.0 / FREQUENCY
    flow, start = flow_of(driven)
    found = periodic_orbit(flow, flow.after(start, 20 * period), period)
    save_table(orbit_table(found, flow.system, driven), tmp_path / "orbit.nc")
    kept = open_orbit(tmp_path / "orbit.nc")
    multipliers = kept["multiplier_real"].values + 1j * kept["multiplier_imaginary"].values
    assert np.array_equal(multipliers, found.multipliers)
    # Both are of the size exp(-c T / 2 m), which differences of runs give to their doubt.
    assert np.abs(multipliers) == pytest.approx(math.exp(-0.5 * C * period), abs=1e-7)
    assert np.array_equal(kept["tangent"], found.tangent) and list(kept["to"].values) == list(found.names)
    assert kept["q"].sel(configuration="way") == found.start.q[0]
    assert str(kept["coordinate_unit"].item()) == "m/s"
    assert kept["stability"].item() == "stable" and kept["period"] == period
    state = State.from_json(str(kept["state"].item()))
    assert state == found.start  # bit for bit, memory and step size too
    assert kept.attrs["title"] == driven.title and kept.attrs["name"] == driven.name
    assert json.loads(kept.attrs["versions"]) == library_versions()


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("scenario", [1.0, 2.0], "in the attribute 'scenario', which must be text"),
        ("scenario", "[]", "'[]' in the attribute 'scenario', which must be a table, as JSON, or nothing"),
        ("versions", "[", "'[' in the attribute 'versions', which must be texts by name"),
        ("verdict", None, "no attribute 'verdict'"),
        ("interval", -1.0, "-1.0 in the attribute 'interval', which must be finite, 0 or more"),
        ("interval", "long", "'long' in the attribute 'interval', which must be a number"),
    ],
)
def test_a_dataset_with_another_attribute_than_declared_is_refused(driven, tmp_path, name, value, said):
    """As a hand may leave it that seals it anew."""
    found = largest_exponent(*flow_of(driven), 1.0 / FREQUENCY, count=4)
    table = exponents_table(found, driven)
    table.attrs = {key: one for key, one in table.attrs.items() if key != name}
    table.attrs |= {} if value is None else {name: value}
    save_table(table, tmp_path / "exponents.nc")
    with pytest.raises(FileFormatError, match=re.escape(said)):
        open_exponents(tmp_path / "exponents.nc")


def test_a_branch_comes_back_from_its_file_with_amplitudes(driven, tmp_path):
    """Over the force the steady state of a linear oscillator is as large as its closed form."""
    key = "drives.motor.amplitude"
    family = family_of(driven, key)
    flow, period = family(FORCE)
    found = continued(family, flow.after(flow_of(driven)[1], 20 * period), (FORCE, 2.0 * FORCE), arc=0.5)
    sizes = amplitudes(found, family, ["q[way]", "v[way]"])
    save_table(branch_table(found, flow.system, key, "N", driven, sizes), tmp_path / "branch.nc")
    kept = open_branch(tmp_path / "branch.nc")
    assert kept["value"].values.tolist() == [point.value for point in found.points]
    w = 2.0 * math.pi * FREQUENCY
    way = kept["value"].values / abs(K - w**2 + 1j * C * w)
    # A sampled top is short by (w dt)^2 / 8 at most, that is by 3.1e-5 for 400 samples a period.
    assert kept["amplitude"].sel(quantity="q[way]").values == pytest.approx(way, rel=3.2e-5)
    assert kept["amplitude"].sel(quantity="v[way]").values == pytest.approx(w * way, rel=3.2e-5)
    assert kept["amplitude_unit"].values.tolist() == ["m", "m/s"]
    states = [State.from_json(str(text)) for text in kept["state"].values]
    assert all(state == point.orbit.start for state, point in zip(states, found.points, strict=True))
    assert kept.sizes["bifurcation"] == 0 and kept.attrs["message"] == found.message
    (span,) = stability_spans(kept)
    assert span.stability == "stable" and span.orbits == len(found.points)
    assert unexplained_changes(kept) == []


def test_the_period_of_a_family_is_that_of_the_drive_at_each_value(driven):
    family = family_of(driven, "drives.motor.frequency", multiple=3)
    assert family(0.5)[1] == 6.0 and family(0.25)[1] == 12.0
    assert family_of(driven, "drives.motor.frequency", period=2.0)(0.5)[1] == 2.0
    with pytest.raises(InvalidParameterError, match="multiple must be 1 or more, got 0"):
        family_of(driven, "drives.motor.frequency", multiple=0)


def test_exponents_come_back_from_their_file(driven, tmp_path):
    flow, start = flow_of(driven)
    found = largest_exponent(flow, start, 0.5, 40)
    save_table(exponents_table(found, driven), tmp_path / "exponents.nc")
    kept = open_exponents(tmp_path / "exponents.nc")
    for name, values in (("value", found.values), ("error", found.errors), ("growth", found.growth)):
        assert np.array_equal(kept[name], values)
    # What is told as its convergence ends in what is told as its value.
    assert kept["running"].values[-1] == pytest.approx(kept["value"].values, rel=1e-12)
    assert kept["time"].values[-1] == pytest.approx(kept["length"].sum().item(), rel=1e-12)
    assert kept.attrs["verdict"] == found.verdict
    assert State.from_json(kept.attrs["end"]) == found.end


def test_a_file_of_something_else_is_refused_in_one_line(driven, tmp_path):
    flow, start = flow_of(driven)
    path = tmp_path / "exponents.nc"
    save_table(exponents_table(largest_exponent(flow, start, 0.5, 4), driven), path)
    with pytest.raises(FileFormatError, match="must be a periodic solution, of format 'antenna_pin orbit 1'"):
        open_orbit(path)
    with pytest.raises(FileFormatError, match="bifurcation diagram"):
        open_diagram(path)
    with pytest.raises(FileFormatError, match="no such file"):
        open_branch(tmp_path / "none.nc")
    content = bytearray(path.read_bytes())
    place = content.index(b"contracting") if b"contracting" in content else content.index(b"too short")
    content[place] ^= 1
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="another checksum") as error:
        open_exponents(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", ["orbit", "exponents"])
def test_every_column_of_a_table_is_held_to_its_rule(driven, tmp_path, kind):
    """Edited by hand and sealed anew."""
    flow, start = flow_of(driven)
    if kind == "orbit":
        table = orbit_table(periodic_orbit(flow, start, 1.0 / FREQUENCY), flow.system, driven)
    else:
        table = exponents_table(largest_exponent(flow, start, 1.0 / FREQUENCY, 3), driven)
    assert problem_of_table(table, kind) is None
    for column in TABLES[kind]:
        changed = table.copy(deep=True)
        values = changed[column.name].values
        if column.words is None:
            wrong = -1.0 if column.rule.least == 0.0 else math.nan
            changed[column.name] = (column.dims, np.full(values.shape, wrong))
        elif column.words:
            changed[column.name] = (column.dims, np.full(values.shape, "perhaps", dtype=object))
        else:
            changed = changed.drop_vars(column.name)
        said = problem_of_table(changed, kind)
        assert said is not None and repr(column.name) in said, (column.name, said)
        assert problem_of_table(table.drop_vars(column.name), kind) == f"no variable {column.name!r}"
    name, opened = ("residual", open_orbit) if kind == "orbit" else ("length", open_exponents)
    save_table(table.assign({name: -table[name] - 1.0}), tmp_path / "sealed.nc")
    with pytest.raises(
        FileFormatError, match=f"in '{name}'.* which must be finite, 0 or more; make it again"
    ):
        opened(tmp_path / "sealed.nc")


def test_every_kind_has_one_format():
    assert len(set(FORMATS.values())) == len(FORMATS)
