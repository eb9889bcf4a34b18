"""What tests of scenario files share."""

import pytest
from scenario_files import TORQUE, URDF, Folder


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "body.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "torque.csv").write_text(TORQUE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return Folder(tmp_path)
