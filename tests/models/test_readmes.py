"""Pages of the shipped models name all of their cases."""

import tomllib

from antenna_pin import models_path

# Their pages describe families of cases.
BY_FAMILY = ("bai2020", "liu2013")
CASES = [
    (file.parent, case)
    for file in sorted(models_path().glob("*/scenario.toml"))
    if file.parent.name not in BY_FAMILY
    for case in tomllib.loads(file.read_text(encoding="utf-8")).get("cases", ())
]


def test_the_readme_names_every_case():
    for folder, case in CASES:
        assert f"`{case}`" in (folder / "README.md").read_text(encoding="utf-8"), (folder, case)
