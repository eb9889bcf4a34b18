"""Random breaks: what is drawn is Python that differs, and always the same."""

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def scripts():
    """The module of sites, and the script."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "scripts"))
        yield importlib.import_module("break_sites"), importlib.import_module("random_breaks")


def test_what_is_drawn_is_python_that_differs(scripts):
    kind, _ = scripts
    drawn = kind.draw(ROOT, 300, 0)
    assert len(set(drawn)) == 300
    assert {one.room for one in drawn} == set(kind.rooms(ROOT))
    for one in drawn:
        text = (ROOT / one.path).read_text(encoding="utf-8")
        assert text[one.start :].startswith(one.old) and one.new != one.old, str(one)
        compile(one.made(text), str(one.path), "exec")


def test_a_longer_draw_begins_as_a_shorter_one(scripts):
    kind, _ = scripts
    assert kind.draw(ROOT, 70, 0)[:40] == kind.draw(ROOT, 40, 0) != kind.draw(ROOT, 40, 1)
    assert {one.room for one in kind.draw(ROOT, 5, 0, "fit")} == {"fit"}


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
    kind, _ = scripts
    made = {(one.old, one.new) for one in kind.sites(TEXT, "room", ROOT / "antenna_pin" / "a.py", ROOT)}
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


def test_a_break_lives_if_all_tests_pass_and_the_tree_is_put_right(scripts, tmp_path):
    kind, script = scripts
    text = "def size():\n    return 2\n\n\ndef other():\n    return 3.0\n"
    for name, content in {
        "antenna_pin/__init__.py": "",
        "antenna_pin/room/__init__.py": "",
        "antenna_pin/room/a.py": text,
        "tests/room/test_a.py": "from antenna_pin.room.a import size\n\n\ndef test_size():\n    assert size() == 2\n",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
    own, other = kind.sites(text, "room", tmp_path / "antenna_pin" / "room" / "a.py", tmp_path)
    assert (own.old, other.old) == ("2", "3.0")
    assert script.test_files(tmp_path, own) == (["tests/room/test_a.py"], [])
    known = {other.key: "nobody calls it"}
    assert script.verdict(tmp_path, other, known, 60.0) == "equivalent"
    assert (tmp_path / "antenna_pin" / "room" / "a.py").read_text(encoding="utf-8") == text
