"""What a release says of itself is one thing in all files, and the changelog keeps its form."""

import importlib
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def release(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    return importlib.import_module("release_check")


def test_version_and_licence_are_those_of_pyproject(release):
    assert release.metadata_faults() == []


FILES = ("pyproject.toml", "CITATION.cff", ".zenodo.json", "CHANGELOG.md")


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("version", "9.9.9", ".zenodo.json: version is '9.9.9', in pyproject.toml '{version}'"),
        (
            "publication_date",
            "2020-01-31",
            ".zenodo.json: publication_date is '2020-01-31', in CHANGELOG.md '{day}'",
        ),
    ],
)
def test_another_version_or_day_in_one_file_is_told(release, tmp_path, key, value, fault):
    for name in FILES:
        (tmp_path / name).write_text((ROOT / name).read_text())
    released = re.sub(r"## \[Unreleased\].*?(?=## \[\d)", "", (ROOT / "CHANGELOG.md").read_text(), flags=re.S)
    (tmp_path / "CHANGELOG.md").write_text(released)
    said = json.loads((tmp_path / ".zenodo.json").read_text())
    (tmp_path / ".zenodo.json").write_text(json.dumps(said | {key: value}))
    assert release.metadata_faults(tmp_path) == [
        fault.format(version=said["version"], day=said["publication_date"])
    ]


def test_a_changelog_of_an_older_version_is_told(release, tmp_path):
    """A version has its section of the changelog; what is unreleased has no day yet."""
    for name in FILES:
        (tmp_path / name).write_text((ROOT / name).read_text())
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## [0.0.1] - 2020-01-31\n")
    assert release.metadata_faults(tmp_path)[0].startswith(
        "CHANGELOG.md: the newest is '0.0.1', in pyproject.toml "
    )
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## [Unreleased]\n\n## [0.0.1] - 2020-01-31\n")
    assert release.metadata_faults(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("tests/test_release.py", "wheel"),
        ("antenna_pin/__pycache__/kernels.nbi", "wheel"),
        ("build/docs/site/index.html", "source"),
        ("models/bai2020/case3.nc", "source"),
    ],
)
def test_what_nobody_needs_is_not_in_an_archive(release, name, kind):
    sound = {
        "wheel": [
            "antenna_pin/__init__.py",
            "antenna_pin/py.typed",
            "antenna_pin/native/shim.cpp",
            "antenna_pin/_models/bai2020/scenario.toml",
            "antenna_pin-1.0.0.dist-info/METADATA",
        ],
        "source": [
            "pyproject.toml",
            "LICENSE",
            "README.md",
            "CHANGELOG.md",
            "models/bai2020/scenario.toml",
            "tests/conftest.py",
        ],
    }[kind]
    assert release.contents_faults(sound, kind) == []
    assert release.contents_faults([*sound, name], kind) == [f"{kind}: holds {name}"]
    assert release.contents_faults(sound[1:], kind) == [f"{kind}: lacks {sound[0]}"]


def test_the_changelog_keeps_its_form(release):
    assert release.changelog_faults((ROOT / "CHANGELOG.md").read_text()) == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("# Changes\n", "the first line must be '# Changelog'"),
        ("# Changelog\n## 1.0.0\n", "must be '## [Unreleased]' or '## [1.2.3] - 2026-01-31'"),
        ("# Changelog\n## [1.0.0] - 2026-01-31\n### News\n", "'News' must be one of Added, Changed, "),
        ("# Changelog\n## [Unreleased]\n### Added\n### Added\n", "'Added' stands there twice"),
        ("# Changelog\n## [1.0.0] - 2026-01-31\n## [Unreleased]\n", "what is unreleased must come first"),
        (
            "# Changelog\n## [1.0.0] - 2026-01-31\n## [1.1.0] - 2026-02-01\n",
            "versions must fall from top to bottom, each once",
        ),
    ],
)
def test_another_form_is_told(release, text, fault):
    (said,) = release.changelog_faults(text)
    assert fault in said


def test_versions_are_ordered_by_number_not_by_letters(release):
    text = "# Changelog\n## [0.10.0] - 2026-02-01\n### Fixed\n## [0.9.0] - 2026-01-31\n"
    assert release.changelog_faults(text) == []


def test_a_tag_of_another_version_is_refused():
    script = str(ROOT / "scripts" / "check" / "release_check.py")
    command = [sys.executable, script, "--no-install", "--tag", "v9.9.9"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stdout.startswith("the tag is v9.9.9, of version ")
