"""Tables on terminals of any width, and the same numbers for programs."""

import csv
import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from antenna_pin import load_scenario, simulate
from antenna_pin.apps.cli._tables import TextTable, laid_out

NUMBERS = st.floats(allow_nan=False, allow_infinity=False).map(lambda x: f"{x:.6g}")
WORDS = st.text("abcdefghij[]/", min_size=1, max_size=9)
LABELS = st.lists(WORDS, min_size=1, max_size=7).map(" ".join)


@st.composite
def tables(draw):
    columns = draw(st.integers(1, 7))
    rows = draw(st.lists(st.tuples(LABELS, *[NUMBERS] * columns), max_size=5))
    head = ["", *draw(st.lists(LABELS, min_size=columns, max_size=columns))]
    return TextTable(title=draw(LABELS), head=head, rows=rows, numbers=draw(st.booleans()))


@given(table=tables(), width=st.integers(1, 140))
def test_no_number_and_no_word_is_split_at_any_width(table, width):
    lines = laid_out(table, width)
    printed = " ".join(lines).replace(":", "").split()
    words = [word for row in table.rows for cell in row for word in cell.split()]
    assert not set(words) - set(printed)
    assert all(printed.count(word) >= words.count(word) for word in set(words))
    longest = max(map(len, [*words, *(word for name in table.head for word in name.split())]), default=0)
    # Beside its words a line has an edge, or two blanks and the colon of a record.
    assert all(len(line) <= max(width, longest + 3, len(table.title)) for line in lines)
    assert all(line == line.rstrip() for line in lines)


def test_columns_that_do_not_fit_go_down():
    """Of four files at 40 characters two stand side by side, and each number once beside its name."""
    head = ["", "one", "two", "three", "four"]
    rows = [["peak force [N]", "1.23456e-05", "2.5", "3.5", "4.5"], ["episodes", "-", "-", "3", "4"]]
    lines = laid_out(TextTable(title="files", head=head, rows=rows, sparse=True), 40)
    assert [line.split() for line in lines if line and "─" not in line] == [
        ["files"],
        ["one", "two"],
        ["peak", "force", "[N]", "1.23456e-05", "2.5"],
        ["three", "four"],
        ["peak", "force", "[N]", "3.5", "4.5"],
        ["episodes", "3", "4"],
    ]


def test_a_title_cannot_command_the_terminal(cli, tmp_path):
    """Nor can a name or a cell: their control characters are shown, as many letters as they take."""
    evil = "t\x1b]0;owned\x07"
    table = TextTable(title=evil, head=["", f"a\n{evil}"], rows=[[evil, "1"], ["mass", evil]])
    for width in (1, 20, 200):
        lines = laid_out(table, width)
        assert all(line.isprintable() for line in lines)
        assert "".join(lines).count(r"t\x1b]0;owned\x07") >= 4
    scenario = load_scenario("pendulum", case="ideal", overrides={"title": evil})
    file = simulate(scenario, duration=1e-3).save(tmp_path / "run.nc")
    at_set = ["--case", "ideal", "--set", r'title="t\u001b]0;owned\u0007"']
    for words in (["info", file], ["info", "pendulum", *at_set], ["modes", "pendulum", *at_set]):
        said = cli(*words)
        assert said.code == 0, said.err
        assert (
            r"t\x1b]0;owned\x07" in said.out and re.sub(r"[\n\N{NO-BREAK SPACE}]", "", said.out).isprintable()
        )


def test_a_long_name_of_a_file_does_not_widen_its_column():
    lines = laid_out(TextTable(title="", head=["", "f" * 60], rows=[["mass", "1"]]), 200)
    assert max(map(len, lines)) < 40
    assert sum(line.count("f") for line in lines) == 60


# --- for programs ---


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    file = tmp_path_factory.mktemp("result") / "play.nc"
    overrides = ["clearance.elevation.geometry=closed-form"]
    simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.03).save(file)
    return file


COMMANDS = {
    "info": ("info", "FILE"),
    "run": ("run", "bai2020", "--case", "case1", "--duration", "1 ms", "--out", "one.nc", "--no-progress"),
    "analyse": ("analyse", "FILE"),
    "impacts": ("impacts", "FILE"),
    "pointing": ("pointing", "FILE", "--direction", "1,0,0.1"),
    "contact list": ("contact", "list"),
    "contact curve": ("contact", "curve", "hertz"),
    "contact restitution": ("contact", "restitution", "--no-simulate", "--asked", "0.5"),
    "contact experiment": ("contact", "experiment"),
    "contact scenarios": ("contact", "scenarios"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_that_prints_numbers_gives_them_to_programs(cli, result, tmp_path, name):
    words = [str(result) if word == "FILE" else word for word in COMMANDS[name]]
    said = cli(*words, "--json", "--csv", "numbers.csv")
    assert (said.code, said.err) == (0, "")
    (line,) = said.out.splitlines()
    found = json.loads(line, parse_constant=lambda constant: pytest.fail(f"{constant} is no JSON"))
    with (tmp_path / "numbers.csv").open(newline="") as stream:
        rows = list(csv.reader(stream))
    assert len(rows) > 1
    assert len({len(row) for row in rows}) == 1
    # A number of the file is one of the object, to the last digit.
    both = {float(text) for text in re.findall(r"(?<![\w.])-?\d[\d.]*(?:e[-+]\d+)?(?![\w.])", line)}
    numbers = {
        float(cell) for row in rows[1:] for cell in row if re.fullmatch(r"-?\d+\.\d+(e[-+]\d+)?", cell)
    }
    assert numbers
    assert numbers <= both
    assert found
    alone = cli(*words, "--csv", "again.csv")
    assert alone.out.splitlines()[-1] == ("saved one.nc" if name == "run" else "saved again.csv")
    assert "─" not in alone.out


def test_a_csv_file_of_results_has_one_row_each(cli, result):
    said = cli("info", result, result, "--csv", "two.csv")
    assert said.code == 0
    with open("two.csv", newline="") as stream:
        first, second = csv.DictReader(stream)
    assert first == second
    assert first["outcome"] == "COMPLETED"
    assert float(first["elevation.radial+ peak force [N]"]) > 0.0


def test_a_csv_file_that_cannot_be_written_is_refused_before_any_work(cli):
    said = cli("run", "bai2020", "--duration", "1 s", "--csv", "missing/numbers.csv")
    assert said.code == 2
    assert "missing" in said.err
    said = cli("info", "bai2020", "--csv", "numbers.csv")
    assert said.code == 2
    assert "--csv" in said.err
