"""What README.md and docs/ say is so: commands and their output, examples, links.

A block that shows a file names it (```` ```python file=scripts/examples/x.py ````) and must equal it.
Commands in ```` ```console ```` blocks are run from top to bottom, in a folder where ``scripts`` is that of
the checkout, and what they print must agree but for what differs between machines: to three digits, or to
those that the block is marked with (``digits=2``; ``digits=0`` is the order of magnitude), as the text after
it says too. Blocks marked ``slow`` are run by the slow tests; one that is marked ``apart`` begins in an empty
folder. To bring blocks up to date::

    python tests/test_readme.py --write [--slow] [PAGE.md ...]

Reference tables are made by ``scripts/pages/reference.py``, see ``tests/test_reference.py``.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import runpy
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from antenna_pin.apps.cli import app

ROOT = Path(__file__).parents[1]
DOCUMENTS = (
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "coming-from").glob("*.md")),
)
FENCE = re.compile(r"^```(\w*)(.*)\n((?:.*\n)*?)```$", re.MULTILINE)


def documents(test: Callable[..., None]) -> Callable[..., None]:
    return pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)(test)


# --- blocks that show a file ---


def shown_file(info: str) -> Path | None:
    found = re.search(r"\bfile=(\S+)", info)
    return ROOT / found.group(1) if found else None


def with_files(text: str) -> str:
    """Return a document whose blocks hold what the files have that they show."""

    def fill(match: re.Match[str]) -> str:
        language, info, _ = match.groups()
        path = shown_file(info)
        return match.group() if path is None else f"```{language}{info}\n{path.read_text()}```"

    return FENCE.sub(fill, text)


@documents
def test_every_example_is_the_file_it_names(path):
    text = path.read_text()
    assert with_files(text) == text, "run: python tests/test_readme.py --write"
    for language, info, _ in FENCE.findall(text):
        assert language not in ("python", "toml", "xml") or shown_file(info), "an example must be a file"


def test_every_example_is_shown_and_run():
    text = "".join(path.read_text() for path in DOCUMENTS)
    for path in (ROOT / "scripts" / "examples").glob("*.py"):
        name = path.relative_to(ROOT).as_posix()
        assert f"file={name}" in text
        assert f"\n$ python {name}\n" in text


# --- commands and their output ---

# Of these the numbers are the machine's, or round-off. A limit that is exceeded fails the command; limits of
# time are for those who run it to judge, since tests run beside each other.
_TIMED = "rhs run engine loop threads sweep scaling startup result figures pages session tangent"
_TIMINGS = tuple(f"bench/{name}.py" for name in _TIMED.split())
_OWN_NUMBERS = (
    *_TIMINGS,
    "bench/accuracy.py",
    "bench/bai2020.py",
    "bench/effective_mass.py",
    "bench/flexible.py",
    "random_scenarios.py",
)
_ROUND_OFF = (
    "wall time",
    "gross work",
    "error",
    "drift",
    "coal against",
    "ledger",
    "step halved",
    "steps",
    "evaluations",
    "simulated in",
    "closes to",
)
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+|×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?![\w.])")


_PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def _value(text: str) -> float:
    return float(text.translate(_PLAIN).replace("×10", "e"))


def commands(block: str) -> Iterator[tuple[str, str]]:
    """Yield the commands of a console block and the output shown."""
    for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, output = part.partition("\n")
        yield command, output


def run(command: str, folder: Path) -> tuple[str, int]:
    """Return what a command prints in a folder (both streams) and its exit code."""
    if not (folder / "scripts").exists():
        (folder / "scripts").symlink_to(ROOT / "scripts")
    words = shlex.split(command)
    before = Path.cwd()
    os.chdir(folder)
    try:
        if words[0] == "antenna-pin":
            own, _, rest = command.partition(" | ")
            result = CliRunner().invoke(app, shlex.split(own)[1:], catch_exceptions=False)
            output, code = result.output, result.exit_code
            if rest:  # a pipe takes what is said, not what is complained, and its last command's verdict
                said, code = in_shell(rest, folder, result.stdout)
                output = result.stderr + said
        elif words[0] == "python" and words[1].startswith("scripts/examples/"):
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                runpy.run_path(words[1], run_name="__main__")
            output, code = stream.getvalue(), 0
        else:
            output, code = in_shell(command, folder)
    finally:
        os.chdir(before)
    lines = [line.rstrip() for line in output.splitlines()]
    return "".join(f"{line}\n" for line in lines if line), code


def in_shell(command: str, folder: Path, given: str = "") -> tuple[str, int]:
    """Return what a shell command prints and its exit code; ``python`` and ``antenna-pin`` are those here."""
    names = folder / "bin"
    names.mkdir(exist_ok=True)
    for name, call in (("python", ""), ("antenna-pin", "-m antenna_pin.apps.cli ")):
        script = names / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {call}"$@"\n')
        script.chmod(0o755)
    path = f"{names}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command,
        shell=True,
        input=given,
        env=os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.stdout, done.returncode


# A search ends by one of its tolerances: by which, and after how many runs, is a matter of round-off.
_ENDED = re.compile(r"\d+ runs; the (?:parameters move|sum of squares falls) no more")


def agree(a: float, b: float, digits: int) -> bool:
    """Return whether numbers are the same to so many digits; to none: within a factor of ten."""
    if digits == 0 and a and b:
        return 0.1 <= a / b <= 10.0
    # Single impacts are repeated to 1e-6 within 0.2 s; compilers may order sums otherwise.
    return abs(a - b) <= 10.0**-digits * abs(a)


def _bands(line: str) -> dict[int, float]:
    """Return the band of each number of a line that has one behind it, as in ``2.00 m  ± 0.03 m``."""
    numbers = list(_NUMBER.finditer(line))
    return {
        k: _value(band[0])
        for k, (number, band) in enumerate(pairwise(numbers))
        if "±" in line[number.end() : band.start()] and "±" not in line[: number.start()]
    }


def disagreement(command: str, shown: str, found: str, digits: int = 3) -> str:
    """Return the first line in which outputs differ by more than machines may, or ""."""
    own_numbers = any(name in command for name in _OWN_NUMBERS)
    right, left = (_ENDED.sub("ended", text).splitlines() for text in (found, shown))
    if command == "antenna-pin list":  # models may be added
        return "" if set(left) <= set(right) else "a model or case is not there"
    for one, other in zip(left, right, strict=False):
        words, others = (" ".join(_NUMBER.sub("#", line).split()) for line in (one, other))
        if words != others and not set(words) == set(others) == {"─"}:
            return f"shown: {one}\nfound: {other}"
        if own_numbers or any(name in one for name in _ROUND_OFF):
            continue
        bands = _bands(one) if digits < 3 else {}
        pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
        for k, (a, b) in enumerate((_value(a), _value(b)) for a, b in pairs):
            if not (abs(a - b) <= bands[k] / 3.0 if k in bands else agree(a, b, digits)):
                return f"shown: {one}\nfound: {other}"
    return "" if len(left) == len(right) else f"shown: {len(left)} lines\nfound: {len(right)} lines"


def is_slow(info: str) -> bool:
    return "slow" in info.split()


def digits_of(info: str) -> int:
    """Return to how many digits the numbers of a block hold on any machine."""
    found = re.search(r"\bdigits=(\d)\b", info)
    return int(found[1]) if found else 3


def slow_parts(path: Path) -> list[list[tuple[str, str]]]:
    """Return the slow blocks of a document, info and commands, by those that need files of one another."""
    parts: list[list[tuple[str, str]]] = []
    for language, info, block in FENCE.findall(path.read_text()):
        if language == "console" and is_slow(info):
            if not parts or "apart" in info.split():
                parts.append([])
            parts[-1].append((info, block))
    return parts


def check_commands(blocks: list[tuple[str, str]], folder: Path) -> None:
    problems = []
    for info, block in blocks:
        for command, shown in commands(block):
            found, code = run(command, folder)
            if any(name in command for name in _TIMINGS):
                found, shown, code = (*(text.replace("  MISSED", "") for text in (found, shown)), 0)
            refused = shown.startswith("antenna-pin: ")
            if (code != 0) != refused:
                problems.append(f"$ {command}\nexit code {code}\n{found}")
            elif difference := disagreement(command, shown, found, digits_of(info)):
                problems.append(f"$ {command}\n{difference}")
    assert not problems, "\n\n".join([*problems, "to update: python tests/test_readme.py --write"])


@documents
def test_commands_print_what_is_shown(path, tmp_path):
    every = FENCE.findall(path.read_text())
    blocks = [(info, block) for language, info, block in every if language == "console" and not is_slow(info)]
    check_commands(blocks, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    "blocks",
    [
        pytest.param(part, id=f"{path.name}-{k}")
        for path in DOCUMENTS
        for k, part in enumerate(slow_parts(path), start=1)
    ],
)
def test_slow_commands_print_what_is_shown(blocks, tmp_path):
    check_commands(blocks, tmp_path)


_HOLD = ("the order of magnitude", "one digit", "two digits")


@documents
def test_numbers_that_move_from_machine_to_machine_say_so(path):
    """A block that is marked is followed by a sentence on the digits that hold."""
    text = path.read_text()
    for block in FENCE.finditer(text):
        if (digits := digits_of(block[2])) != 3:
            behind = " ".join(text[block.end() :].split("\n\n")[:2][-1].split())
            assert f"from machine to machine numbers hold to {_HOLD[digits]}" in behind.lower(), block[2]


def test_numbers_hold_to_the_digits_that_are_marked():
    shown = "a 1.000 N\n"
    assert not disagreement("", shown, "a 1.0009 N\n")
    assert disagreement("", shown, "a 1.002 N\n")
    assert not disagreement("", shown, "a 1.009 N\n", 2)
    assert disagreement("", shown, "a 1.02 N\n", 2)
    assert not disagreement("", shown, "a 9.9 N\n", 0) and not disagreement("", shown, "a 0.11 N\n", 0)
    assert disagreement("", shown, "a 11 N\n", 0) and disagreement("", shown, "a -1 N\n", 0)
    assert digits_of(" slow digits=1") == 1 and digits_of(" slow") == 3
    # A value to a third of its band.
    fitted = "a  2.00 N m  ± 0.030 N m (95 %)\n"
    assert not disagreement("", fitted, "a  2.009 N m  ± 0.040 N m (95 %)\n", 0)
    assert disagreement("", fitted, "a  2.020 N m  ± 0.040 N m (95 %)\n", 0)
    assert disagreement("", fitted, "a  2.000 N m  ± 0.040 N m (95 %)\n")
    ended = "chi2 482.1; 97 runs; the parameters move no more\n"
    assert not disagreement("", ended, "chi2 482.1; 102 runs; the sum of squares falls no more\n")
    assert disagreement("", ended, "chi2 482.1; 97 runs; it was stopped\n")


# --- links and pictures ---


def anchors(path: Path) -> set[str]:
    """Return the names by which a link finds the headings of a document."""
    headings = re.findall(r"^#+ (.*)$", FENCE.sub("", path.read_text()), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@documents
def test_links_lead_somewhere(path):
    text = FENCE.sub("", path.read_text())
    for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)", text):
        if re.match(r"https?://", target):
            continue
        file = path.parent / target if target else path
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), f"{target}#{anchor}"


def test_every_page_is_linked_from_the_readme():
    readme, *pages = DOCUMENTS
    for page in pages:
        assert f"]({page.relative_to(ROOT).as_posix()}" in readme.read_text(), page.name


def test_the_page_on_the_command_line_names_every_command():
    commands = get_command(app).commands
    page, *_ = (ROOT / "docs" / "command-line.md").read_text().split("<!-- table:")
    named = {
        name
        for row in re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
        for name in re.findall(r"`(.*?)`", row)
    }
    assert named == set(commands)


def test_pictures_are_small():
    for path in (ROOT / "docs" / "images").iterdir():
        assert path.stat().st_size < 300e3, path.name


# --- bringing the documents up to date ---


def write(slow: bool, names: list[str]) -> None:
    for path in [path for path in DOCUMENTS if not names or path.name in names]:
        text = with_files(path.read_text())
        with tempfile.TemporaryDirectory() as folder:

            def fill(match: re.Match[str], folder: Path = Path(folder)) -> str:
                language, info, block = match.groups()
                if language != "console" or (is_slow(info) and not slow):
                    return match.group()
                done = "".join(f"$ {command}\n{run(command, folder)[0]}" for command, _ in commands(block))
                return f"```{language}{info}\n{done}```"

            path.write_text(FENCE.sub(fill, text))


if __name__ == "__main__":
    if "--write" not in sys.argv:
        sys.exit("usage: python tests/test_readme.py --write [--slow] [PAGE.md ...]")
    write("--slow" in sys.argv, [name for name in sys.argv[1:] if not name.startswith("-")])
