"""The example notebooks run from top to bottom, show what they should, and are kept without outputs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "scripts" / "examples").glob("*.ipynb"))


def notebooks(test: Any) -> Any:
    return pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)(test)


def test_there_are_notebooks():
    assert {path.stem for path in NOTEBOOKS} >= {"look_at_a_run", "pointing_budget"}


@notebooks
def test_it_is_kept_without_outputs(path):
    """Outputs would be megabytes of recordings, and would tell of another version."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert cell.outputs == [] and cell.execution_count is None


@pytest.mark.slow
@notebooks
def test_it_runs_and_shows(path, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")  # else Jupyter warns of a change to come
    for name in ("JUPYTER_RUNTIME_DIR", "IPYTHONDIR", "JUPYTER_CONFIG_DIR"):
        monkeypatch.setenv(name, str(tmp_path / name))
    notebook = nbformat.read(path, as_version=4)
    folder = tmp_path / "work"
    folder.mkdir()
    NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(folder)}}
    ).execute()
    outputs = [
        (cell.source.splitlines()[-1], output)
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
    ]
    assert outputs
    said = [output for _, output in outputs if output.output_type == "stream" and output.name == "stderr"]
    assert said == []
    if path.stem != "look_at_a_run":
        return
    shown = {line: output.data for line, output in outputs if "data" in output}
    assert "peak force" in shown["run"]["text/html"]
    assert "image/png" in shown['run.plot("motion_acceleration", beside=ideal, joint="elevation")']
    for line in ("run.record(ideal=ideal)", 'run.record(view="joint")'):
        assert shown[line]["text/html"].startswith("<iframe srcdoc=")
    assert (folder / "look_at_a_run.html").stat().st_size > 1e6
