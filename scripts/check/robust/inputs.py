"""Inputs: files, the command or call that reads them, changes of them, and what must come of it."""

from __future__ import annotations

import contextlib
import io
import itertools
import re
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from antenna_pin import AntennaPinError
from antenna_pin.apps.cli import app
from antenna_pin.errors import printable
from robust.trials import Content, TrialError, must, write_files

#: Most letters that a refusal may have.
LINE = 1200

#: Exit codes: done; refused; ended before the end time with a result; ledger open; no minimum of a fit.
_DONE, _REFUSED, _EARLY, _UNBALANCED, _DOUBTFUL = 0, 2, 3, 4, 5

# Lines on the error stream of a command that was not refused: notes and bars of progress.
_NOTE = re.compile(r"antenna-pin: (?!.*(encountered in|Warning))|.*━|\s*$")


@dataclass(frozen=True)
class Change:
    """One change of a sound input."""

    name: str  # description
    apply: Callable[[Any], Any]  # applies the change to an object of the draft's maker
    wrong: bool = False  # whether it alone must be refused, whatever else the input holds
    says: tuple[str, ...] = ()  # texts of which a refusal must hold one; any refusal will do if there is none


@dataclass(frozen=True)
class Input:
    """Files in an empty folder, and what is done with them there."""

    files: Mapping[str, Content]  # contents by name, or functions that write them
    act: Sequence[str] | Callable[[], Any]  # arguments of the command, or a call in Python
    strict: bool = False  # whether any warning is an error, and any line beside that of a refusal


@dataclass(frozen=True)
class Draft:
    """A sound input and changes of it."""

    changes: tuple[Change, ...]  # changes; any part of them makes an input
    # Returns the input with some of the changes.
    made: Callable[[Sequence[Change]], Input] = field(repr=False)

    @property
    def name(self) -> str:
        """Names of all changes, in one line."""
        return "; ".join(change.name for change in self.changes) or "nothing changed"


def several(chance: Random, draw: Callable[[], Change], *counts: int) -> tuple[Change, ...]:
    """Return so many drawn changes as one of some counts."""
    return tuple(draw() for _ in range(chance.choice(counts)))


def after(changes: Iterable[Change], content: Any) -> Any:
    """Return a content after changes of which each returns another; None, of a file that is gone, stays."""
    for change in changes:
        content = None if content is None else change.apply(content)
    return content


def more_words(*words: str) -> Change:
    """Return a change that appends words to those of a command."""
    return Change(ascii(" ".join(words)[:100]), lambda given: given.extend(words))


def draft_of_words(
    changes: Iterable[Change], words: Sequence[str], files: Callable[[], Mapping[str, Content]]
) -> Draft:
    """Return the draft of a command whose words are changed, in a folder with files."""

    def made(kept: Sequence[Change]) -> Input:
        given = list(words)
        for change in kept:
            change.apply(given)
        return Input(files(), given)

    return Draft(tuple(changes), made)


# --- what comes of an input --------------------------------------------------------------------------------


def problem_of(draft: Draft, folder: Path) -> str | None:
    """Return a fault in what comes of an input; None if there is none."""
    wrong = len(draft.changes) == 1 and draft.changes[0].wrong
    try:
        refusal = _refusal(draft.made(draft.changes), folder)
    except TrialError as error:
        return str(error)
    except BaseException as error:
        return f"{type(error).__name__}: {error} ({_where(error)})"
    if refusal is None:
        return "not refused" if wrong else None
    says = draft.changes[0].says if wrong else ()
    if says and not any(one in refusal for one in says):
        return f"the refusal names none of {', '.join(says)}: {refusal[:300]!r}"
    return None


def problem_apart(draft: Draft) -> str | None:
    """Return a fault in what comes of an input, in a folder of its own."""
    with tempfile.TemporaryDirectory(prefix="robust-") as folder:
        return problem_of(draft, Path(folder))


def _refusal(given: Input, folder: Path) -> str | None:
    """Return the line that refuses an input; None if it is done."""
    write_files(folder, given.files)
    with contextlib.chdir(folder), _as_errors(given.strict):
        if not callable(given.act):
            return _commanded(given.act, folder, given.strict)
        try:
            given.act()
        except AntennaPinError as error:
            return _line(str(error), given.strict)
    return None


def _run(words: Sequence[str]) -> tuple[Any, str, str]:
    """Return exit code, standard output and error stream of a command in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app(list(words), prog_name="antenna-pin")
        except SystemExit as ended:
            return ended.code or _DONE, out.getvalue(), err.getvalue()
    return _DONE, out.getvalue(), err.getvalue()


def _commanded(words: Sequence[str], folder: Path, strict: bool) -> str | None:
    before = set(folder.rglob("*"))
    code, out, err = _run(words)
    if code == _REFUSED and "--check" in words and not err:  # many files may be refused
        files = [folder / value for option, value in itertools.pairwise(words) if option == "--out"]
        reports = [out, *(path.read_text(encoding="utf-8") for path in files if path.is_file())]
        *others, err = [line for line in "".join(reports).splitlines() if "refused: " in line] or [""]
        for line in others:
            _line(line, strict)
    notes, last = err.splitlines() if code != _UNBALANCED else [], ""
    if code == _REFUSED:
        last = notes.pop() if notes else ""
        left = [str(path.relative_to(folder)) for path in set(folder.rglob("*")) - before]
        # Runs, or reports of files, from before.
        kept = words[0] in ("sweep", "figures", "bifurcation") or "--check" in words
        must(not left or kept, f"refused, and left {', '.join(left)}: {err[:200]!r}")
    elif code not in (_DONE, _EARLY, _UNBALANCED, _DOUBTFUL):
        raise TrialError(f"exit code {code}, said {(err or out)[-300:]!r}")
    for line in notes:
        must(_NOTE.match(line) and not (strict and code == _REFUSED), f"exit code {code}, said {err[:400]!r}")
    return _line(last, strict) if code == _REFUSED else None


def quietly(words: Sequence[str], folder: Path) -> None:
    """Run a command that must be done, in a folder."""
    with contextlib.chdir(folder):
        code, _, err = _run(words)
    if code not in (_DONE, _EARLY):
        raise ValueError(f"{' '.join(words)}: {err}")


@contextlib.contextmanager
def _as_errors(strict: bool) -> Iterator[None]:
    """Raise warnings of NumPy and Python; those of the package itself only if strict."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if not strict:
            warnings.filterwarnings("always", category=UserWarning)
            warnings.filterwarnings("ignore", category=DeprecationWarning)
        yield


def _line(text: str, strict: bool) -> str:
    plain = text.isprintable() if strict else printable(text) == text
    must(plain and len(text.splitlines()) == 1, f"not one plain line: {text[:300]!r}")
    must(len(text) <= LINE, f"a line of {len(text)} letters: {text[:200]!r}")
    return text


def _where(error: BaseException) -> str:
    """Return the package's own line that an error came from."""
    place, trace = "", error.__traceback__
    while trace is not None:
        path = Path(trace.tb_frame.f_code.co_filename)
        if "antenna_pin" in path.parts or not place:
            place = f"{path.name}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place
