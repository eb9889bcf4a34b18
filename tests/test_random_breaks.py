"""Random breaks: what is drawn is Python that differs, and always the same."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


ROOMS = ["margins", "session", "statics"]


@pytest.fixture(scope="module")
def scripts():
    """The module of sites, of which some small rooms take turns."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "scripts" / "check"))
        kind = importlib.import_module("break_sites")
        assert {*ROOMS, "simulation", kind.TOP} < set(kind.rooms(ROOT))
        patch.setattr(kind, "rooms", lambda root: ROOMS)
        yield kind


def test_what_is_drawn_is_python_that_differs(scripts):
    kind = scripts
    drawn = kind.draw(ROOT, 60, 0)
    assert [one.room for one in drawn] == 20 * ROOMS
    for one in drawn:
        text = (ROOT / one.path).read_text(encoding="utf-8")
        assert text[one.start :].startswith(one.old) and one.new != one.old, str(one)
        compile(one.made(text), str(one.path), "exec")


def test_a_longer_draw_begins_as_a_shorter_one(scripts):
    kind = scripts
    assert kind.draw(ROOT, 70, 0)[:40] == kind.draw(ROOT, 40, 0) != kind.draw(ROOT, 40, 1)
    assert {one.room for one in kind.draw(ROOT, 5, 0, "statics")} == {"statics"}


def test_what_was_drawn_is_found_again_where_its_line_is_now(scripts, tmp_path):
    text = "x = 1\n\n\ndef a(b):\n    x = 1\n    return b + 1\n\n\ndef c(b):\n    x = 1\n    return b * 2\n"
    first, moved = tmp_path / "antenna_pin/room/a.py", tmp_path / "antenna_pin/room/b.py"
    first.parent.mkdir(parents=True)
    first.write_text(text, encoding="utf-8")
    drawn = scripts.sites(text, "room", first.relative_to(tmp_path))
    kept = [one.kept(tmp_path) for one in drawn]
    first.rename(moved)
    moved.write_text(f"y = 0\n{text.replace('b + 1', 'b')}", encoding="utf-8")
    for one, place in zip(drawn, kept, strict=True):
        again = scripts.found_again(tmp_path, place)
        if "b + 1" in f"{one.before}{one.old}{one.after}":
            assert again is None
        else:
            assert (again.path, again.line, again.key[1:]) == (
                moved.relative_to(tmp_path),
                one.line + 1,
                one.key[1:],
            )


def test_where_machine_code_is_tied_to_a_file_kernels_run_as_python(scripts):
    tied = {"compiled/jit.py", "base/records.py", "elements/spring.py", "contact/damping.py"}
    for path in (*tied, "base/units.py", "show/plot/fits.py"):
        assert scripts.sites("x = 1\n", "room", Path("antenna_pin", path))[0].plain == (path in tied), path


TEXT = '''"""A docstring with 1."""
__all__ = ["a"]
x: float = -2.5
unit = "N"
name = "other"


def a(b, c, *, d: int = 1):
    """Return 2 of them."""
    if not b and c[0] < 3:
        raise ValueError(f"{b} is 4")
    return b * c - f(b, c), b @ c, True
'''


def test_all_kinds_of_break_are_made_and_no_text_for_people(scripts):
    kind = scripts
    made = {(one.old, one.new) for one in kind.sites(TEXT, "room", Path("antenna_pin/a.py"))}
    assert made == {
        ("-2.5", "(2.5)"),
        ("2.5", "3.75"),
        ('"N"', "'N m'"),
        ("1", "2"),
        ("not b and c[0] < 3", "((not b) or (c[0] < 3))"),
        ("not b and c[0] < 3", "(not b)"),
        ("not b", "(b)"),
        ("c[0] < 3", "((c[0]) >= (3))"),
        ("0", "1"),
        ("3", "4"),
        ("b * c - f(b, c)", "((b * c) + (f(b, c)))"),
        ("b * c - f(b, c)", "((f(b, c)) - (b * c))"),
        ("b * c", "((b) / (c))"),
        ("b * c", "(b)"),
        ("b, c", "c, b"),
        ("b @ c", "((c) @ (b))"),
        ("True", "False"),
    }


TESTS = """
from antenna_pin.room.a import size


def test_size():
    assert size() == 2
"""


PLACES = """class A:
    size = 1

    def a(self, b=2):
        if b:
            return 3
        elif b > 4:
            b = [
                5,
            ]
        return lambda c=6: 7
"""


def test_a_probe_stands_before_the_statement_of_a_place(scripts):
    hits = importlib.import_module("break_hits")
    lines = {
        one.old: hits.statement_of(PLACES, one.start) for one in scripts.sites(PLACES, "room", Path("a.py"))
    }
    assert lines == {"1": None, "2": None, "3": 6, "b > 4": 5, "4": 5, "5": 8, "6": 11, "7": 11}


PROGRAM = """
import sys
from pathlib import Path
from break_sites import sites
from random_breaks import found_hits, test_files, verdict
tree, path = Path(sys.argv[1]), Path("antenna_pin/room/a.py")
own, other = sorted(sites((tree / path).read_text(), "room", path), key=lambda one: one.start)
assert (own.old, other.old) == ("2", "3.0")
assert test_files(tree, own) == (["tests/room/test_a.py"], [])
for one, known in ((own, {}), (other, {}), (other, {other.key: "nobody calls it"})):
    print(verdict(tree, one, known, 60.0), flush=True)
import random_breaks
random_breaks.ROOT = tree
hits = found_hits(Path(sys.argv[2]), [own, other], 2)
print(hits.of[1] == ["tests/room/test_a.py::test_size"], hits.of[2] == [], *hits.seconds)
print(verdict(tree, other, {}, 60.0, hits.tests(2, ("tests/room/",))))
"""


def test_a_break_lives_if_all_tests_pass_and_the_tree_is_put_right(tmp_path, tmp_path_factory):
    text = "def size():\n    return 2\n\n\ndef other():\n    return 3.0\n"
    for name, content in {
        "antenna_pin/__init__.py": "",
        "antenna_pin/room/__init__.py": "",
        "antenna_pin/room/a.py": text,
        "tests/room/test_a.py": TESTS,
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
    # In a process that has not imported the package.
    command = [sys.executable, "-c", PROGRAM, str(tmp_path), str(tmp_path_factory.mktemp("hits"))]
    env = {**os.environ, "PYTHONPATH": str(ROOT / "scripts" / "check")}
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[:3] == ["killed", "lived", "equivalent"]
    assert lines[-2:] == ["True True tests/room/test_a.py::test_size", "unreached"]
    assert (tmp_path / "antenna_pin" / "room" / "a.py").read_text(encoding="utf-8") == text
