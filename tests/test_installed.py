"""The wheel works away from the checkout: its models come with it."""

import json
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


#: One process for all commands: each start would import everything anew. What one prints is a JSON string.
CALLS = """
import contextlib, io, json, sys
import antenna_pin.apps.cli as cli
print(cli.__file__)
for call in sys.argv[1:]:
    sys.argv = ["antenna-pin", *call.split()]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        try:
            cli.main()
        except SystemExit as ended:
            if ended.code:
                sys.exit(f"{call}: exit code {ended.code}")
    print(json.dumps(said.getvalue()))
"""


def run(site, folder, *calls):
    """Run the installed command line in another folder, before any other copy of the package.

    Returns the lines that each of the calls prints.
    """
    environment = os.environ | {"PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", CALLS, *calls],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    where, *lines = done.stdout.splitlines()
    assert where == str(site / "antenna_pin" / "apps" / "cli" / "__init__.py")
    return [json.loads(line).splitlines() for line in lines]


@pytest.mark.slow
def test_shipped_models_are_found_by_name_and_run(site, tmp_path):
    listed, ran = run(
        site,
        tmp_path,
        "list",
        "run bai2020 --case case1 --duration 0.001 --no-progress --no-summary",
    )
    assert listed[0].startswith("bai2020: ")
    assert ran == ["saved bai2020-case1.nc"]
    assert (tmp_path / "bai2020-case1.nc").is_file()


@pytest.mark.slow
def test_recordings_and_reports_are_made_from_what_is_installed(site, tmp_path):
    """Scripts of the player and templates of the report come along."""
    _, recorded, reported = run(
        site,
        tmp_path,
        "run impact_pair --case contact --duration 0.001 --out a.nc -q",
        "record a.nc --out a.html",
        "report a.nc --out b.html --no-figures",
    )
    assert recorded[-1] == "saved a.html"
    assert "AntennaPin.mount" in (tmp_path / "a.html").read_text(encoding="utf-8")
    assert reported[-1] == "saved b.html"


def test_type_information_and_licence_come_along(site):
    assert (site / "antenna_pin" / "py.typed").is_file()
    assert list(site.glob("antenna_pin-*.dist-info/licenses/LICENSE"))


def test_only_the_package_is_installed(site):
    assert {path.name.split("-")[0] for path in site.iterdir()} == {"antenna_pin"}
