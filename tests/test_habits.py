"""What those who come next are told is so: workflow, hooks, citation and CONTRIBUTING.md."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LINTS = re.findall(r"^check (.+)$", (ROOT / "scripts" / "test").read_text(encoding="utf-8"), re.MULTILINE)


def test_the_workflow_runs_what_is_run_here_on_every_python():
    workflow = (ROOT / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8")
    assert "- run: scripts/test\n" in workflow
    named = re.search(r"python: \[(.*)\]", workflow)
    assert named is not None
    versions = re.findall(r'"3\.(\d+)"', named[1])
    least = re.fullmatch(r">=3\.(\d+)", PROJECT["requires-python"])
    assert least is not None and versions[0] == least[1]
    assert list(map(int, versions)) == list(range(int(versions[0]), int(versions[-1]) + 1))


def test_hooks_lint_what_the_tests_lint():
    hooks = (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8")
    entries = re.findall(r"entry: \.venv/bin/(.+)", hooks)
    assert entries == LINTS != []
    assert "repo: http" not in hooks  # the tools that are installed, not others of the same name


def test_the_citation_is_of_this_version():
    cited = dict(
        re.findall(r"^(\w[\w-]*): (\S.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    )
    assert cited["version"] == PROJECT["version"]
    assert cited["license"] == PROJECT["license"]
    assert cited["title"].replace("_", "-") == PROJECT["name"]


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", ".github/ISSUE_TEMPLATE/bug.yml"])
def test_files_that_are_named_are_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    folders = "|".join(path.name for path in ROOT.iterdir() if path.is_dir() and path.name[0] != ".")
    named = set(re.findall(rf"\b(?:(?:{folders})/[\w./-]*[\w/]|\w+\.(?:toml|txt|cff|md)\b)", text))
    named -= {"contact/hysteresis.py"}
    assert page != "CONTRIBUTING.md" or len(named) > 15
    missing = [name for name in sorted(named) if not (ROOT / name).exists()]
    assert missing == []
