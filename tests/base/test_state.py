"""States as text: exact, and refused by place where no run leaves such a number."""

import dataclasses
import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from antenna_pin import load_scenario, simulate
from antenna_pin.apps.cli import app
from antenna_pin.base.state import EventMemory, OpenContact, State, breach_of_state
from antenna_pin.errors import AntennaPinError, FileFormatError, InvalidParameterError


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("impact_pair", case="contact")


@pytest.fixture(scope="module")
def end(scenario):
    """A state in contact."""
    found = simulate(scenario, duration=2e-4).end
    contact = {
        "contact": 0,
        "onset": 0.0,
        "approach_speed": 0.1,
        "effective_mass": 1.0,
        "impulse": -0.0,
        "dissipated": -0.0,
        "peak": (1.0, 0.0, 1e-6),
        "peak_state": found.y,
        "peak_memory": found.memory,
    }
    event = EventMemory(name="e", count=0, last=-math.inf, side=0.0, noise=0.0)
    return dataclasses.replace(
        found,
        contacts=(OpenContact(**contact),),
        events=(event,),
        sizes=(("1", 1e-5),),
        adjusted=(("a.b", 1.0),),
    )


def test_a_whole_state_is_read_bit_for_bit(end):
    assert breach_of_state(end) is None
    assert State.from_json(end.to_json()) == end


def broken(text, path, value):
    """Return the text of a state with another value at a path."""
    content = json.loads(text)
    where = content
    for key in path[:-1]:
        where = where[key]
    where[path[-1]] = value
    return json.dumps(content)


NAMED = [(name,) for name in ("time", "reached", "step", "error", "q", "v", "x", "memory")]
INSIDE = [("q", 0), ("v", 1), ("x", 0), ("memory", 0, 1), ("changed", 0), ("events", 0, "noise")]
INSIDE += [("events", 0, "last"), ("sizes", 0, 1), ("adjusted", 0, 1)]
INSIDE += [("contacts", 0, name) for name in ("contact", "onset", "effective_mass", "peak")]
INSIDE += [("contacts", 0, "peak", 2), ("contacts", 0, "peak_state", 0)]


@pytest.mark.parametrize("value", [None, "1.0", math.nan, True, {}])
@pytest.mark.parametrize("path", NAMED + INSIDE, ids=lambda path: "-".join(map(str, path)))
def test_what_no_run_leaves_is_refused_with_its_place(end, path, value):
    if path[0] == "changed" and value is True:
        pytest.skip("true is 1 to Python, and as good")
    with pytest.raises(FileFormatError) as refused:
        State.from_json(broken(end.to_json(), path, value))
    place = str(path[0]) + "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path[1:])
    said = str(refused.value)
    assert said.startswith("state: ") and "must be" in said and "got" in said and "\n" not in said
    # Of a pair the place is the pair's.
    assert place.removesuffix("[1]") in said if path[0] in ("sizes", "adjusted") else place in said


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("reached",), -1.0),
        (("step",), 0.0),
        (("step",), 10**400),
        (("contacts", 0, "contact"), 7),
        (("q",), [[1.0]]),
        (("x", 0), 10**400),
    ],
)
def test_what_is_a_number_and_cannot_be_is_refused(end, path, value):
    with pytest.raises(FileFormatError, match=path[0]):
        State.from_json(broken(end.to_json(), path, value))


@pytest.mark.parametrize("text", ["[]", "null", "1", "{}", "[" * 100_000, "{"])
def test_text_that_is_no_state_is_refused(text):
    with pytest.raises(FileFormatError, match=r"^state: must be one that a run wrote"):
        State.from_json(text)


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"reached": math.nan}, "start.reached"),
        ({"q": None}, "start.q"),
        ({"q": "text"}, "start.q"),
        ({"x": np.array([math.nan])}, r"start.x\[0\]"),
    ],
)
def test_from_python_likewise(scenario, end, change, place):
    with pytest.raises(InvalidParameterError, match=f"simulate: {place} must be"):
        simulate(scenario, duration=1e-4, start=dataclasses.replace(end, **change))


def test_the_command_line_names_the_file(tmp_path, end):
    path = tmp_path / "state.json"
    path.write_text(broken(end.to_json(), ("q",), None))
    found = CliRunner().invoke(
        app, ["sensitivity", "impact_pair", "--case", "contact", "--start", str(path), "gap"]
    )
    assert isinstance(found.exception, AntennaPinError | SystemExit)
    said = found.output + str(found.exception)
    assert "state.json" in said and "q must be a list of numbers, got null" in said
