"""The wheel works away from the checkout: its models come with it."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder that holds what the wheel installs, and nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = subprocess.run(build, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    # Machine code that the checkout holds already fits, being tied to contents and not to places.
    for compiled in (ROOT / "antenna_pin").rglob("__pycache__/*.nb[ic]"):
        place = folder / "site" / compiled.relative_to(ROOT)
        place.parent.mkdir(exist_ok=True)
        shutil.copyfile(compiled, place)
    return folder / "site"


def run(site, folder, *arguments):
    """Run the installed command line in another folder, before any other copy of the package."""
    code = "import sys, antenna_pin.cli as cli; print(cli.__file__); sys.argv[0] = 'antenna-pin'; cli.main()"
    environment = os.environ | {"PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    where, *lines = done.stdout.splitlines()
    assert where == str(site / "antenna_pin" / "cli" / "__init__.py")
    return lines


def test_shipped_models_are_found_by_name(site, tmp_path):
    assert run(site, tmp_path, "list")[0].startswith("bai2020: ")


def test_a_shipped_scenario_runs(site, tmp_path):
    lines = run(
        site, tmp_path, *"run bai2020 --case case1 --duration 0.001 --no-progress --no-summary".split()
    )
    assert lines == ["saved bai2020-case1.nc"]
    assert (tmp_path / "bai2020-case1.nc").is_file()


def test_a_recording_is_made_from_what_is_installed(site, tmp_path):
    run(site, tmp_path, *"run impact_pair --case contact --duration 0.001 --out a.nc -q".split())
    assert run(site, tmp_path, *"record a.nc --out a.html".split())[-1] == "saved a.html"
    assert "AntennaPin.mount" in (tmp_path / "a.html").read_text(encoding="utf-8")
    # So is a report: its templates come along.
    assert run(site, tmp_path, *"report a.nc --out b.html --no-figures".split())[-1] == "saved b.html"


def test_type_information_and_licence_come_along(site):
    assert (site / "antenna_pin" / "py.typed").is_file()
    assert list(site.glob("antenna_pin-*.dist-info/licenses/LICENSE"))


def test_only_the_package_is_installed(site):
    assert {path.name.split("-")[0] for path in site.iterdir()} == {"antenna_pin"}
