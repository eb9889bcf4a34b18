"""What motions come to, in a report: each file has its section, with its numbers, verdict and command."""

import base64
import zlib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import phase_portrait, portrait_table, recurrence
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.show.report import report
from antenna_pin.studies.nonlinear import (
    Stroboscope,
    bifurcation,
    branch_table,
    continued,
    exponents_table,
    family_of,
    flow_of,
    largest_exponent,
    orbit_table,
    periodic_orbit,
    poincare,
)
from antenna_pin.studies.sensitivity import sensitivities, sensitivity_table
from antenna_pin.trajectory import save_table

KEY, PERIOD = "drives.motor.amplitude", 1.6
DRIVE = "drives.motor={joint = 'hinge', kind = 'sine', amplitude = '1 N*m', frequency = '0.625 Hz'}"


@pytest.fixture(scope="module")
def known():
    """The driven pendulum without play, by the engine that is quick."""
    return load_scenario("pendulum", case="ideal", overrides=[DRIVE, "integrator.engine='compiled'"])


@pytest.fixture(scope="module")
def run(known):
    return simulate(known, duration=3.2)


@pytest.fixture(scope="module")
def found(known, run):
    """One of each kind, by kind."""
    flow, start = flow_of(known)
    orbit = periodic_orbit(flow, flow.after(start, 20 * PERIOD), PERIOD)
    branch = continued(family_of(known, KEY), orbit.start, (1.0, 2.0), arc=0.5)
    values = ["1 N*m", "1.5 N*m"]
    made = {"transient": 20, "count": 32}
    return {
        "portrait": portrait_table(phase_portrait(run, "motion_angle", "motion_rate"), run),
        "section": poincare(known, Stroboscope(), ["motion_angle[hinge]", "v[hinge]"], **made),
        "bifurcation": bifurcation(known, KEY, values, Stroboscope(), ["v[hinge]"], workers=1, **made),
        "orbit": orbit_table(orbit, flow.system, known),
        "branch": branch_table(branch, flow.system, KEY, "N*m", known),
        "exponents": exponents_table(largest_exponent(flow, orbit.start, 0.2, 40), known),
        "sensitivity": sensitivity_table(
            sensitivities(known, [KEY], np.linspace(0.2, 2.0, 10), method="quick-runs"), known
        ),
    }


@pytest.fixture(scope="module")
def saved(found, run, tmp_path_factory):
    """The page of all of them as files beside a run, with the command that a file says it is of."""
    folder = tmp_path_factory.mktemp("found")
    files = [run.save(folder / "run.nc")]
    for kind, table in found.items():
        files.append(folder / f"{kind}.nc")
        save_table(table.assign_attrs(command=f"antenna-pin {kind} <b>"), files[-1])
    return report(files, recordings=False).save(folder / "all.html")


@pytest.fixture(scope="module")
def told(saved, shown):
    return shown(saved.read_text(encoding="utf-8"))


def section_of(kind, found):
    return f"finding-{list(found).index(kind) + 1}"


def test_each_has_a_section_with_a_figure_and_its_command(told, found):
    for kind in found:
        key = section_of(kind, found)
        said = told.said(key)
        assert said["repeat it"] == f"antenna-pin {kind} <b>"  # and so it is escaped
        assert said["versions"] == "those of this report" and said["file"].endswith(f"{kind}.nc")
        assert said["scenario"].startswith("pendulum: Pendulum on a hinge with play, case ideal")
        pictures = told.tree.xpath(f"//section[@id='{key}']//figure[@class='picture']/script/text()")
        assert len(pictures) == (2 if kind == "branch" else 1)
        assert all(b"<svg" in zlib.decompress(base64.b64decode(one)) for one in pictures)
    heads = told.text("//section[@id='outcome']")
    for words in ("section settled", "orbit stable", "branch stable", "exponents contracting"):
        assert words in heads
    assert all(f"{kind}.nc" in told.said("provenance")["repeat this report"] for kind in found)
    keys = told.tree.xpath("//@id")
    assert len(keys) == len(set(keys))


def test_numbers_are_those_of_the_datasets(told, found):
    key = {kind: section_of(kind, found) for kind in found}
    points = found["section"]["v[hinge]"].values
    shown = told.numbers(f"{key['section']}-range", "v[hinge]")
    assert shown == [points.min(), points.max(), points.mean(), points[-1]]
    orbit, branch, exponents = found["orbit"], found["branch"], found["exponents"]
    first = told.numbers(f"{key['orbit']}-multipliers", "1")
    real, imaginary = float(orbit["multiplier_real"][0]), float(orbit["multiplier_imaginary"][0])
    size = np.hypot(real, imaginary)  # of one of a pair, told with its angle; a real one with its sign
    assert first == [real if imaginary == 0.0 else size, size, float(orbit["exponent"][0])]
    said = told.said(key["orbit"])
    onsets, events = int(orbit["onsets"].item()), int(orbit["events"].item())
    assert said["in a period"] == f"{onsets} contacts that begin, {events} events"
    assert said["ends of a period"].endswith("error scales apart")
    values = branch["value"].values
    assert told.numbers(f"{key['branch']}-stability", "stable")[:3] == [values[0], values[-1], len(values)]
    value, error = float(exponents["value"][0]), float(exponents["error"][0])
    assert told.numbers(f"{key['exponents']}-exponents", "1") == [value, error, value * 0.2]
    rate = found["portrait"]["motion_rate[hinge]"].values
    assert told.numbers(f"{key['portrait']}-range", "motion_rate[hinge]")[1] == rate.max()


def test_a_portrait_names_its_axes(run, shown):
    """Of two quantities the second is drawn over the first; three are told in their order."""
    for names, title in (
        (["motion_angle", "motion_rate"], "motion_rate[hinge] over motion_angle[hinge]"),
        (["motion_rate", "motion_angle", "v"], "motion_rate[hinge], motion_angle[hinge], v[hinge]"),
    ):
        made = shown(report(portrait_table(phase_portrait(run, *names), run), figures=False).html)
        assert f"{title}, of " in made.text("//section[@id='finding-1']")
        assert len(made.rows("finding-1-range")) == len(names)


def test_verdicts_are_those_of_the_judges(told, found):
    points = np.column_stack([found["section"][name].values for name in ("motion_angle[hinge]", "v[hinge]")])
    words = recurrence(points).words
    assert words == "period 1" and f"recur: {words}" in told.text("//section[@id='finding-2']")
    rows = told.rows("finding-3-values")
    assert [cells[0][0] for cells in rows.values()] == ["period 1", "period 1"]
    assert found["exponents"].attrs["verdict"] in told.text("//section[@id='finding-6']")


def test_what_has_not_settled_is_said_at_the_top(found, shown):
    bad = found["section"].assign(settled=False, drift=0.3)
    failed = found["bifurcation"].copy(deep=True)
    failed["points"][0, 1] = 0
    failed["message"][0, 1] = "the run makes no way"
    made = shown(report([bad, failed], figures=False).html)
    assert len(made.tree.xpath("//p[@class='status bad']")) == 2
    assert "NOT settled, drift 0.3" in made.text("//section[@id='finding-1']")
    assert "failed: the run makes no way" in made.text("//section[@id='finding-2']")


def test_without_runs_there_is_nothing_of_runs(found, shown):
    made = shown(report(found["orbit"], title="One").html)
    assert [one.get("id") for one in made.tree.xpath("//section")] == ["outcome", "finding-1", "provenance"]
    assert made.text("//h1") == "One"


def test_what_is_none_of_them_is_refused_in_one_line(found, tmp_path, cli):
    other = tmp_path / "other.nc"
    save_table(found["orbit"].assign_attrs(format="antenna_pin orbit 0"), other)
    for refused, message in (
        (other, "must be a run, a phase portrait, .* got format 'antenna_pin orbit 0'"),
        (tmp_path / "none.nc", "no such file"),
    ):
        with pytest.raises(FileFormatError, match=message) as error:
            report([refused])
        assert "\n" not in str(error.value)
    with pytest.raises(InvalidParameterError, match="must be datasets of a phase portrait"):
        report(xr.Dataset())
    with pytest.raises(InvalidParameterError, match="must be at least one run"):
        report([])
    (tmp_path / "text.nc").write_text("no dataset")
    said = cli("report", "text.nc", "--out", "report.html")
    assert (
        said.code == 2 and said.err.startswith("antenna-pin: text.nc: must be") and said.err.count("\n") == 1
    )


def test_the_command_takes_files_of_all_kinds(found, run, cli, shown):
    run.save("run.nc")
    save_table(found["section"], "section.nc")
    said = cli("report", "section.nc", "run.nc", "--out", "page.html", "--no-figures", "--no-recordings")
    assert (said.code, said.out) == (0, "saved page.html\n")
    made = shown(Path("page.html").read_text(encoding="utf-8"))
    assert made.said("provenance")["repeat this report"].startswith("antenna-pin report section.nc run.nc")
    assert made.numbers("key-results", "simulated time") == [3.2]
    assert list(made.rows("finding-1-range")) == ["motion_angle[hinge]", "v[hinge]"]


@pytest.mark.parametrize(("width", "mobile"), [(380, True), (1280, False)])
def test_no_page_is_wider_than_its_screen(check_width, saved, width, mobile):
    """Long commands and names of quantities are broken or scrolled; a phone shows all of it."""
    check_width(saved, width, 800, mobile)
