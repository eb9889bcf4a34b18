"""Tests that a change reaches: what imports it, through exports and registries too."""

import importlib
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = {
    "antenna_pin/__init__.py": "",
    "antenna_pin/room/__init__.py": "",
    "antenna_pin/room/__init__.pyi": "from antenna_pin.room.far import Far as Far\n",
    "antenna_pin/room/far.py": "class Far: ...\n",
    "antenna_pin/room/registry.py": 'KINDS = {"a": "spring.Spring"}\n',
    "antenna_pin/room/spring.py": "class Spring: ...\n",
    "antenna_pin/apps/cli/plot.py": "def plot():\n    from antenna_pin.room.near import draw\n",
    "antenna_pin/room/near.py": "def draw(): ...\n",
    "scripts/bench/timer.py": "",
    "tests/conftest.py": "import antenna_pin.room.near\n",
    "tests/test_far.py": "from antenna_pin.room import Far\n",
    "tests/room/test_kinds.py": "from antenna_pin.room.registry import KINDS\nimport timer\n",
    "tests/test_command.py": 'def test(cli):\n    cli("plot", "run.nc")\n',
    "tests/test_pages.py": 'PAGE = "docs/tour.md"\n',
    "docs/tour.md": "",
}


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("antenna_pin/room/far.py", ["tests/test_far.py"]),
        ("antenna_pin/room/spring.py", ["tests/room/test_kinds.py"]),
        ("antenna_pin/room/near.py", ["tests/test_command.py"]),
        ("scripts/bench/timer.py", ["tests/room/test_kinds.py"]),
        ("tests/test_far.py", ["tests/test_far.py"]),
        ("docs/tour.md", ["tests/test_pages.py"]),
        ("README.md", []),
    ],
)
def test_a_change_reaches_what_imports_it(checkout, changed, tests):
    assert importlib.import_module("reached").reached(checkout, {changed}) == tests


def test_files_of_all_tests_reach_all(checkout):
    assert len(importlib.import_module("reached").reached(checkout, {"tests/conftest.py"})) == 4


def test_what_differs_and_what_is_new_has_changed(checkout):
    for words in (
        ("init", "-q"),
        ("add", "-A"),
        ("-c", "user.name=a", "-c", "user.email=a@b.c", "commit", "-qm", "a: b"),
    ):
        subprocess.run(("git", *words), cwd=checkout, check=True)
    (checkout / "antenna_pin/room/far.py").write_text("")
    (checkout / "tests/test_new.py").write_text("")
    found = importlib.import_module("reached").changed_files(checkout, "HEAD")
    assert found == {"antenna_pin/room/far.py", "tests/test_new.py"}
