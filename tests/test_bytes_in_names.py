"""Folders and files whose names are no UTF-8: shown escaped, and found again."""

import os
import shutil

import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.base.files import escaped, path_as_text, path_of_text
from antenna_pin.errors import ScenarioError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.shipped import models_path
from antenna_pin.show.report import report
from antenna_pin.studies.sweep import load_study


@pytest.fixture
def folder(tmp_path):
    """The pendulum's files, in a folder and under a name that are no UTF-8."""
    made = tmp_path / os.fsdecode(b"d\xff 1%41")
    shutil.copytree(models_path() / "pendulum", made)
    shutil.copy(made / "scenario.toml", made / os.fsdecode(b"k\xfe.toml"))
    return made


def test_paths_as_text_are_found_again(folder):
    for path in (folder, folder.parent, folder / "file:" / "x", type(folder)("file%41"), type(folder)()):
        text = path_as_text(path)
        assert text.encode() and path_of_text(text) == path
    assert escaped(folder.name) == "d\\udcff 1%41" and escaped("käse") == "käse"


def test_a_scenario_there_runs_and_its_result_knows_the_folder(folder):
    scenario = load_scenario(folder / os.fsdecode(b"k\xfe.toml"))
    assert scenario.name == "k\\udcfe" and scenario.folder == folder
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario
    path = simulate(scenario, duration=1e-3).save(folder / os.fsdecode(b"r\xfd.nc"))
    run = Trajectory.load(path)
    assert run.scenario.folder == folder
    assert path_of_text(run.data.attrs["urdf_folder"]).samefile(folder)
    page = report(path, figures=False, recordings=False).save(folder / "page.html")
    assert "k\\udcfe" in page.read_text(encoding="utf-8")


def test_a_study_there_is_read_and_written(folder):
    path = folder / os.fsdecode(b"s\xfe.study.toml")
    path.write_text(
        'scenario = "scenario.toml"\n[parameters.span]\nkey = "duration"\nvalues = ["1 ms", "2 ms"]\n'
        '[responses.end]\nmeasure = "energy_error"\n'
    )
    study = load_study(path)
    assert study.name == "s\\udcfe" and study.folder == folder
    assert study.model_dump_json()


def test_a_value_that_is_no_utf8_is_refused_in_one_line(folder):
    with pytest.raises(ScenarioError, match=r"^override mechanism\.urdf=.* must be UTF-8") as refused:
        load_scenario("pendulum", overrides=[f"mechanism.urdf={folder.name}/pendulum.urdf"])
    assert "\n" not in str(refused.value)
