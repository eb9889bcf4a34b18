"""Cases that build on cases."""

import pytest

from antenna_pin import load_scenario, models_path
from antenna_pin.errors import AntennaPinError

URDF = models_path() / "pendulum" / "pendulum.urdf"

FILE = f"""
format = 1
duration = 1
title = "Pendulum"
default_case = "play"
[mechanism]
urdf = "{URDF}"
[clearance.hinge]
model = "planar"
bearing_radius = "10 mm"
radial_clearance = "0.2 mm"
bearing_length = "20 mm"
journal_material = "steel"
bearing_material = "steel"
normal = {{ law = "lankarani-nikravesh", restitution = 0.8 }}
[springs.hinge]
damping = 1
[cases.play]
description = "as the file"
[cases.wide]
base = "play"
clearance.hinge.radial_clearance = "0.5 mm"
springs.hinge = {{ replace = true, stiffness = 3 }}
[cases.soft]
description = "wide, with another law"
base = "wide"
integrator.rtol = 1e-6
springs.hinge.damping = 2
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(FILE)
    return path


def test_a_case_is_laid_over_the_one_it_builds_on(file):
    soft, wide, play = (load_scenario(file, case=name) for name in ("soft", "wide", "play"))
    assert soft.clearance["hinge"].radial_clearance == wide.clearance["hinge"].radial_clearance == 5e-4
    assert play.clearance["hinge"].radial_clearance == pytest.approx(2e-4, rel=1e-12)
    assert (soft.integrator.rtol, wide.integrator.rtol) == (1e-6, play.integrator.rtol)
    # What the middle case replaced stays away, and what the last one adds stands beside the rest.
    assert (wide.springs["hinge"].stiffness, wide.springs["hinge"].damping) == (3.0, 0.0)
    assert (soft.springs["hinge"].stiffness, soft.springs["hinge"].damping) == (3.0, 2.0)
    assert soft.description == "wide, with another law"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('base = "play"', 'base = "plai"', "cases.wide.base: case 'plai' is unknown"),
        (
            'base = "play"',
            'base = "soft"',
            "base must be a case that does not build on this one, got wide - soft",
        ),
        ('base = "play"', "base = 3", "cases.wide.base must be text, the name of a case, got 3"),
        ("stiffness = 3", "stiffnes = 3", "cases.wide.springs.hinge.stiffnes is unknown"),
        ('"0.5 mm"', '"0.5 N"', "cases.wide.clearance.hinge.radial_clearance must be a length"),
        ("rtol = 1e-6", "rtol = -1", "cases.soft.integrator.rtol must be"),
    ],
)
@pytest.mark.parametrize("case", ["soft", "wide"])
def test_what_is_wrong_is_said_where_it_stands(file, case, old, new, message):
    file.write_text(FILE.replace(old, new))
    with pytest.raises(AntennaPinError, match=message):
        load_scenario(file, case=case)


def test_a_file_of_ones_own_is_listed(cli, file):
    said = cli("list", file)
    assert said.code == 0
    assert said.out == "mine: Pendulum\n  play  as the file\n  wide\n  soft  wide, with another law\n"
    assert cli("list", "bai2020").out.startswith("bai2020: Dual-axis")
    missing = cli("list", "nowhere.toml")
    assert missing.code == 2
    assert "no such file" in missing.err
