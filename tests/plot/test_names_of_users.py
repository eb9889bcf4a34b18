"""Names and titles of users stand in figures, pages and tables as they are: no formula is read in them."""

import csv
import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.cbook import is_math_text
from matplotlib.text import Text

from antenna_pin import AntennaPinError, load_scenario, run_study, simulate
from antenna_pin.analysis import Quantity
from antenna_pin.analysis.phase import PhasePortrait
from antenna_pin.contact import LiuPinJoint
from antenna_pin.scenario import scenario_toml
from antenna_pin.scenario.merge import toml_value
from antenna_pin.show.plot import (
    allowed_figures,
    figure_branch,
    figure_correlation,
    figure_force_curves,
    figure_phase,
    figure_profiles,
    figure_response,
    figure_section,
    figure_sensitivity,
    rendered,
    study_figures,
)
from antenna_pin.studies.sweep import load_study

from .test_fits import fit
from .test_periodic import branch

#: What TeX and Matplotlib would stumble over.
ODD = "%$\\frac{_^\\"

LAW = LiuPinJoint(length=1e-3, journal_radius=5e-3, bearing_radius=5.067e-3, modulus=1.13e11)

# Families of tables whose keys are names, and keys whose values are words of the package.
_WORDS = {"base", "bearing", "both", "journal", "joints", "parent", "child", "world"}
_WORDED = {"kind", "law", "model", "geometry", "motion", "urdf", "method", "form"}


def check_names(figure) -> int:
    """Assert that odd names are shown as they are, and return how many texts hold one."""
    count = 0
    for text in figure.findobj(Text):
        own = re.sub(r"^\$\\bf\{\(\w+\)\}\$ ", "", text.get_text())  # the letter of a panel
        if "frac" in re.sub(r"\s", "", own):
            count += 1
            assert not is_math_text(own), own
            # Lines break anywhere, and what joins words of a name is a space in most figures.
            shown = re.sub(r"[\s_]", "", own.replace(r"\$", "$"))
            assert ODD.replace("_", "") in shown, own
    return count


def odd_scenario(folder: Path, name: str, case: str, duration: float):
    """Return a shipped scenario in which all names of joints, links, elements and cases are odd ones."""
    scenario = load_scenario(name, case=case)
    data = tomllib.loads(scenario_toml(scenario))
    named = re.findall(r'<(?:joint|link)\s+name="([^"]+)"', scenario.urdf_text)
    families = {
        key
        for key, table in data.items()
        if key != "initial" and isinstance(table, dict) and all(isinstance(v, dict) for v in table.values())
    }
    names = {*named, *(one for key in families for one in data[key])} - _WORDS

    def odd(one):
        return one + ODD if one in names else one

    def changed(value, key=None):
        if isinstance(value, dict):
            keyed = key in families or key == "joints"
            return {odd(k) if keyed else k: changed(v, None if keyed else k) for k, v in value.items()}
        if isinstance(value, list):
            return [changed(one, key) for one in value]
        return odd(value) if isinstance(value, str) and key not in _WORDED else value

    data = {key: changed(value, key) for key, value in data.items()}
    data |= {"title": f"title {ODD}", "duration": duration}
    data["output"] = data.get("output", {}) | {"rate": 64.0 / duration}
    lines = [f"{key} = {toml_value(value)}" for key, value in data.items()]
    folder.mkdir(exist_ok=True)
    (folder / "scenario.toml").write_text("\n".join([*lines, f"cases = {toml_value({ODD: {}})}"]))
    urdf = re.sub(
        r'(<(?:joint|link)\s+name="|<(?:parent|child)\s+link="|<mimic[^>]*joint=")([^"]+)"',
        lambda found: f'{found[1]}{odd(found[2])}"',
        scenario.urdf_text,
    )
    (folder / scenario.mechanism.urdf).write_text(urdf)
    return load_scenario(folder, case=ODD)


@pytest.mark.parametrize(
    ("name", "case", "duration"),
    [
        ("bai2020", "petals", 0.05),
        ("pointing_gear", "play", 0.05),
        pytest.param("solar_array", "play", 0.02, marks=pytest.mark.slow),
        pytest.param("shaker", "random", 0.2, marks=pytest.mark.slow),
        pytest.param("chen2021", "friction-010", 0.01, marks=pytest.mark.slow),
    ],
)
def test_names_in_figures_of_runs_are_no_formulas(tmp_path, name, case, duration):
    run = simulate(odd_scenario(tmp_path, name, case, duration))
    both = [(f"one {ODD}", run), (f"another {ODD}", run)]
    drawn = {}
    for each in allowed_figures(both):
        if each.figure.name not in drawn:
            try:
                drawn[each.figure.name] = figure = each.draw(both)
            except AntennaPinError:  # too short a run
                continue
            assert check_names(figure) > 0, each.figure.name
    assert len(drawn) > 4
    picture = rendered(next(iter(drawn.values())), "svg").decode()
    assert f"one {ODD}" in picture  # Matplotlib's, and no escape is seen


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    return odd_scenario(tmp_path_factory.mktemp("odd"), "pendulum", "ideal", 0.1)


def test_names_in_other_figures_are_no_formulas():
    labels = np.array([f"play{ODD}", f"k{ODD}"])
    assert check_names(figure_response(response(labels))) > 0
    assert check_names(figure_section(section(labels[0]))) > 0
    walk = np.linspace(0.0, 1.0, 50)
    quantities = tuple(Quantity(one, walk, walk, "m", one) for one in labels)
    portrait = PhasePortrait(run=f"case {ODD}", quantities=quantities, start=0.0, rule="all of it")
    assert check_names(figure_phase(portrait)) == 3
    assert check_names(figure_force_curves({f"law {ODD}": LAW}, depths=[1e-6, 1e-5])) > 0
    assert check_names(figure_sensitivity(sensitivity(labels))) > 0
    odd = branch().assign_attrs(parameter=f"drives.{labels[0]}.amplitude")
    odd = odd.assign_coords(configuration=labels[:1], coordinate=labels[:1])
    assert check_names(figure_branch(odd)) > 0
    named = fit().assign(title=("parameter", labels)).assign_coords(parameter=labels, other=labels)
    assert check_names(figure_correlation(named)) > 0 and check_names(figure_profiles(named)) > 0


def test_titles_in_figures_of_studies_are_no_formulas(pendulum, tmp_path):
    key = f"initial.joints.{toml_value(f'hinge{ODD}')}.angle"
    (tmp_path / "s.study.toml").write_text(
        f"scenario = {toml_value(str(pendulum.folder))}\ncase = {toml_value(ODD)}\nset.duration = '1 ms'\n"
        f"[parameters.start]\ntitle = {toml_value(f'Start {ODD}')}\nvalues = [0.1, 0.2, 0.3]\n"
        f"key = {toml_value(key)}\n"
        f"[responses.error]\nmeasure = 'energy_error'\ntitle = {toml_value(f'Error {ODD}')}\n"
    )
    study = run_study(load_study(tmp_path / "s.study.toml"), tmp_path / "s.study")
    figures = study_figures(study)
    assert sum(check_names(one.draw(width="column")) for one in figures) >= 2


def section(label):
    """Return points of a section, of one quantity."""
    return xr.Dataset(
        {
            str(label): ("point", np.linspace(0.0, 1.0, 40), {"units": "rad"}),
            "time": ("point", np.arange(40.0), {"units": "s"}),
            "transient": ((), 3),
            "settled": ((), 1),
        },
        attrs={"section": f"rate.{label}", "quantities": json.dumps([label])},
    )


def response(labels):
    """Return responses over an odd source."""
    return xr.Dataset(
        {"response": (("frequency", "target"), np.full((3, 2), 1.0 + 1.0j))},
        coords={"frequency": [1.0, 2.0, 3.0], "target": labels, "unit": ("target", ["m/N", "m/N"])},
        attrs={"source": f"drives.{labels[0]}", "resonances": []},
    )


def sensitivity(labels):
    """Return a dataset of derivatives over two parameters."""
    two = np.ones((2, 2))
    return xr.Dataset(
        {
            "change": (("result", "parameter"), two),
            "doubt": (("result", "parameter"), 0.1 * two),
            "value": ("result", [1.0, 2.0]),
            "size": ("result", [1.0, 2.0]),
            "curve_change": (("time", "curve", "parameter"), np.ones((3, 1, 2))),
            "curve_doubt": (("time", "curve", "parameter"), 0.1 * np.ones((3, 1, 2))),
            "curve_unit": ("curve", ["m"]),
        },
        coords={"result": labels, "parameter": labels, "curve": labels[:1], "time": [0.0, 1.0, 2.0]},
    )


def test_names_in_pages_and_tables_are_as_they_are(pendulum, cli, tmp_path):
    """A report with its figures, recordings of mechanism and joint, figures of a run, a table as CSV."""
    simulate(pendulum).save(tmp_path / "run.nc")
    contact = odd_scenario(tmp_path / "contact", "pendulum", "contact", 0.1)
    simulate(contact).save(tmp_path / "contact.nc")
    for words in (
        ("report", "run.nc", "contact.nc", "--out", "report.html", "--no-recordings"),
        ("record", "contact.nc", "--out", "page.html"),
        ("record", "contact.nc", "--view", "joint", "--out", "joint.html"),
        ("plot", "contact.nc", "--figure", "journal_orbit", "--out", "figures"),
        ("impacts", "contact.nc", "--csv", "impacts.csv"),
        ("info", "contact.nc"),
    ):
        said = cli(*words)
        assert said.code == 0, said.err
    for page in ("report", "page", "joint"):
        text = (tmp_path / f"{page}.html").read_text()
        assert f"hinge{ODD}" in text or f"hinge{ODD}".replace("\\", "\\\\") in text
    with (tmp_path / "impacts.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert any(f"hinge{ODD}" in cell for row in rows for cell in row)


def test_a_scenario_with_odd_names_is_written_as_it_is_read(pendulum, tmp_path):
    """Keys with what TOML takes for an escape would be others, or none."""
    (tmp_path / "scenario.toml").write_text(scenario_toml(pendulum))
    (tmp_path / pendulum.mechanism.urdf).write_text(pendulum.urdf_text)
    again = load_scenario(tmp_path)
    own = {name: True for name in ("name", "case", "description", "overrides", "folder")}
    assert again.model_dump(exclude=own) == pendulum.model_dump(exclude=own)
