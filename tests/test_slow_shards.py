"""Slow tests run in six shards: each test in one of them, and none longer than three minutes."""

import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from . import conftest
from .conftest import recorded_seconds, shard_of

ROOT = Path(__file__).parents[1]
COUNT = 6
MINUTES = 20.0  # of a shard by two processes
LONGEST = 180.0  # of one test [s]


def loads(seconds, count=COUNT):
    """Return the sum of durations in each shard [s]."""
    sums = [0.0] * count
    for name in seconds:
        sums[shard_of(name, count, seconds) - 1] += seconds[name]
    return sums


def test_long_tests_are_dealt_by_their_durations():
    """The longest first, each to the shard with the least to do."""
    seconds = {"a": 5.0, "b": 4.0, "c": 3.0, "d": 3.0}
    assert [shard_of(name, 2, seconds) for name in "abcd"] == [1, 2, 2, 1]
    assert loads(seconds, 2) == [8.0, 7.0]


def test_other_tests_are_dealt_by_their_names():
    """1200 names: each shard has its sixth within four standard deviations of a binomial, 52."""
    names = [f"tests/test_x.py::test_y[{number}]" for number in range(1200)]
    counts = [[shard_of(name, COUNT, {}) for name in names].count(shard) for shard in range(1, COUNT + 1)]
    assert sum(counts) == len(names)
    assert all(abs(count - 200) < 52 for count in counts)


def test_recorded_durations_fit_into_shards():
    seconds = recorded_seconds()
    assert len(seconds) > 10
    too_long = {name: time for name, time in seconds.items() if time > LONGEST}
    assert not too_long, "fewer of what they try, or split"
    # Two processes; a third of the time is left for tests shorter than those that are recorded.
    assert max(loads(seconds)) < 2.0 * 60.0 * MINUTES * 2.0 / 3.0
    assert max(loads(seconds)) - min(loads(seconds)) <= LONGEST


def test_recorded_tests_exist():
    for name in recorded_seconds():
        path, _, function = name.partition("::")
        assert f"def {function.partition('[')[0]}(" in (ROOT / path).read_text(encoding="utf-8"), name


def config(deselected=None, **options):
    """Return what the hooks need of a configuration."""
    hook = SimpleNamespace(pytest_deselected=lambda items: deselected.extend(items))
    values = {f"--{name}": value for name, value in options.items()}
    return SimpleNamespace(getoption=values.__getitem__, hook=hook)


def item(name, slow=True):
    """Return what the hooks need of a test."""
    return SimpleNamespace(nodeid=name, path=ROOT / "tests" / "a.py", get_closest_marker={"slow": slow}.get)


def test_shards_hold_each_slow_test_once_and_all_others():
    names = [*recorded_seconds(), *(f"tests/a.py::test_b[{number}]" for number in range(50))]
    held = []
    for number in range(1, COUNT + 1):
        items, deselected = [item(name) for name in names], []
        items.append(item("tests/a.py::test_fast", slow=None))
        conftest.pytest_collection_modifyitems(config(deselected, shard=f"{number}/{COUNT}"), items)
        assert len(items) + len(deselected) == len(names) + 1
        *slow, fast = sorted(items, key=lambda one: one.nodeid == "tests/a.py::test_fast")
        assert fast.nodeid == "tests/a.py::test_fast"
        held += [one.nodeid for one in slow]
    assert sorted(held) == sorted(names)


@pytest.mark.parametrize("shard", ["0/6", "7/6", "3", "a/6", "1/0", "1/6 "])
def test_a_shard_that_does_not_exist_is_refused(shard):
    with pytest.raises(pytest.UsageError, match="--shard must be K/N with K from 1 to N, such as 2/6, got"):
        conftest.pytest_configure(config(shard=shard))


def test_no_slow_test_begins_after_the_time(monkeypatch):
    slow = SimpleNamespace(config=config(minutes=20.0), **vars(item("tests/a.py::test_b")))
    monkeypatch.setattr(conftest, "_BEGUN", time.monotonic() - 1190.0)
    conftest.pytest_runtest_setup(slow)
    monkeypatch.setattr(conftest, "_BEGUN", time.monotonic() - 1210.0)
    with pytest.raises(pytest.skip.Exception, match="did not begin within 20 min; run: scripts/test -m slow"):
        conftest.pytest_runtest_setup(slow)


def test_durations_of_long_tests_are_recorded(monkeypatch, tmp_path):
    """Those that passed now replace those of before; what has become short is left out."""
    path = tmp_path / "seconds.json"
    path.write_text('{"a": 20, "b": 30, "c": 40}')
    monkeypatch.setattr(conftest, "SLOW_SECONDS", path)
    passed = [
        SimpleNamespace(nodeid=name, duration=time) for name, time in (("b", 5.0), ("c", 50.4), ("d", 12.0))
    ]
    reporter = SimpleNamespace(config=config(record=True), getreports={"passed": passed}.get)
    conftest.pytest_terminal_summary(reporter)
    assert recorded_seconds() == {"a": 20, "c": 50, "d": 12}
