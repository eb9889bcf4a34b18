"""The list of mutants fits the tree: texts to change, and tests to run, are there."""

import importlib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_mutant_can_still_be_made(monkeypatch):
    """Its text stands exactly once in its file, and the changed file is still Python."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    mutants = importlib.import_module("mutant_list").MUTANTS
    assert len(mutants) >= 200
    assert len({(one.file, one.old, one.new) for one in mutants}) == len(mutants)
    for one in mutants:
        text = (ROOT / one.file).read_text(encoding="utf-8")
        assert text.count(one.old) == 1, one.note
        assert one.old != one.new, one.note
        compile(text.replace(one.old, one.new), one.file, "exec")
        assert bool(one.equivalent) != bool(one.tests), one.note
        for test in one.tests:
            if test.startswith("tests/"):
                assert (ROOT / test.partition("::")[0]).is_file(), one.note
