"""``antenna-pin record``: pages by the command, and what it refuses in one line."""

import json
import re

import pytest
from typer.testing import CliRunner

from antenna_pin import load_scenario, simulate
from antenna_pin.apps.cli import app


@pytest.fixture(scope="module")
def files(tmp_path_factory, clearance_run, ideal_run):
    folder = tmp_path_factory.mktemp("runs")
    return clearance_run.save(folder / "play.nc"), ideal_run.save(folder / "ideal.nc")


def call(*arguments):
    return CliRunner().invoke(app, ["record", *map(str, arguments)])


def test_meshes_of_packages_are_found_where_the_option_says(tmp_path):
    """A result does not know where packages are on the machine that draws it."""
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    mesh = "<visual><geometry><mesh filename='package://arm/part.stl'/></geometry></visual>"
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="arm"><link name="a"/><link name="b">{body}{mesh}</link>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>'
    )
    (tmp_path / "arm.toml").write_text(
        'format = 1\nduration = "1 ms"\n[mechanism]\nurdf = "arm.urdf"\nbase = "fixed"\n'
    )
    package = tmp_path / "packages" / "arm"
    package.mkdir(parents=True)
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    facet = "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
    (package / "part.stl").write_text(
        f"solid s\nfacet normal 0 0 1\nouter loop\n{facet}endloop\nendfacet\nendsolid s\n"
    )
    result = simulate(load_scenario(tmp_path / "arm.toml")).save(tmp_path / "arm.nc")
    out = tmp_path / "arm.html"
    lost = call(result, "--out", out)
    assert lost.exit_code == 0 and "'package://arm/part.stl'" in lost.stdout
    found = call(result, "--out", out, "--package-path", tmp_path / "packages")
    assert (found.exit_code, found.stdout) == (0, f"saved {out}\n")
    refused = call(result, "--out", out, "--package-path", package / "part.stl")
    assert refused.exit_code == 2 and refused.stderr.count("\n") == 1
    assert "must be a folder, got a file" in refused.stderr


def data_of(path):
    text = path.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="recording-data">(.*?)</script>', text)[1])


def test_pages_by_the_command(files, tmp_path):
    out = tmp_path / "a.html"
    done = call(files[0], "--ideal", files[1], "--out", out, "--speed", "1/8", "--boresight", "0,0,2")
    assert done.exit_code == 0 and done.stdout == f"saved {out}\n"
    data = data_of(out)
    assert data["speed"] == 0.125 and [actor["name"] for actor in data["actors"]] == ["run", "ideal"]
    done = call(
        files[0], "--view", "joint", "--magnify", "250", "--out", out, "--start", "0.01", "--end", "20 ms"
    )
    assert done.exit_code == 0
    assert "250 times" in data_of(out)["facts"][0]["text"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--view", "joint", "--joint", "azimuth"), "joint with clearance 'azimuth' is unknown"),
        (("--start", "1 s"), "recording: start must be within the run, 0 to 0.05 s, got 1.0"),
        (("--end", "3 kg"), "--end must be a time"),
        (("--speed", "fast"), "--speed: speed must be a number or a fraction such as 1/100, got 'fast'"),
        (("--boresight", "1,x"), "record: --boresight must be three numbers such as 1,0,0, got '1,x'"),
        (("--max-size", "0.1"), "max_megabytes must be above"),
        (("--max-size", "nan"), "Invalid value for '--max-size': 'nan' is not a valid float"),
        (("--key-rate", "nan"), "Invalid value for '--key-rate': 'nan' is not a valid float"),
        (("--view", "joint", "--magnify", "-1"), "magnify must be a positive number"),
        (
            ("--magnify", "200"),
            "magnify must be left out in the view of a mechanism without flexible links, got 200.0",
        ),
        (("--view", "joint", "--body", "reflector"), "body must be left out in the view of a joint"),
    ],
)
def test_refusals(files, tmp_path, arguments, message):
    done = call(files[0], "--out", tmp_path / "a.html", *arguments)
    assert done.exit_code == 2
    assert message in done.stderr and done.stderr.count("\n") == 1
    assert not (tmp_path / "a.html").exists()


def test_a_run_of_ideal_joints_has_no_joint_close_up(files, tmp_path):
    done = call(files[1], "--view", "joint", "--out", tmp_path / "a.html")
    assert done.exit_code == 2
    assert "view must be mechanism for a run without a clearance joint" in done.stderr


def test_a_run_of_another_mechanism_is_no_ideal_one(files, tmp_path):
    other = simulate(load_scenario("pendulum", case="ideal"), duration=0.01).save(tmp_path / "other.nc")
    done = call(files[0], "--ideal", other, "--out", tmp_path / "a.html")
    assert done.exit_code == 2
    assert "recording: ideal must be a run of the same mechanism, got" in done.stderr
