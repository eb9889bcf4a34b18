"""Pages of the shipped models name all of their cases."""

import tomllib

import pytest

from antenna_pin import models_path

# Their pages describe families of cases.
BY_FAMILY = ("bai2020", "liu2013")
CASES = [
    pytest.param(file.parent, case, id=f"{file.parent.name}-{case}")
    for file in sorted(models_path().glob("*/scenario.toml"))
    if file.parent.name not in BY_FAMILY
    for case in tomllib.loads(file.read_text(encoding="utf-8")).get("cases", ())
]


@pytest.mark.parametrize(("folder", "case"), CASES)
def test_the_readme_names_every_case(folder, case):
    assert f"`{case}`" in (folder / "README.md").read_text(encoding="utf-8")
