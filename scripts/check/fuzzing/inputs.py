"""What an input is: files, what is done with them, what was changed, and what must come of it."""

from __future__ import annotations

import contextlib
import io
import itertools
import os
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from antenna_pin import AntennaPinError
from antenna_pin.cli import app
from antenna_pin.errors import printable

__all__ = ["LINE", "Change", "Content", "Draft", "Input", "problem_of", "quietly"]

#: Most letters that a refusal may have.
LINE = 1200

#: Exit codes of what was done, refused, and ended before its time with a result that was saved; of a fit that
#: has found no minimum, of a run whose ledger is open.
_DONE, _REFUSED, _EARLY, _UNBALANCED, _DOUBTFUL = 0, 2, 3, 4, 5

# Lines on the error stream of a command that was not refused: notes and bars of progress.
_NOTE = re.compile(r"antenna-pin: (?!.*(encountered in|Warning))|.*━|\s*$")

Content = bytes | str | Callable[[Path], Any]


@dataclass(frozen=True)
class Change:
    """One thing that makes an input another.

    Attributes:
        name: What it is, for people.
        apply: Makes it, on what the draft's maker hands to it.
        wrong: Whether it alone must be refused, whatever else the input says.
        says: Of which a refusal must name one; any refusal will do if there is none.
    """

    name: str
    apply: Callable[[Any], Any]
    wrong: bool = False
    says: tuple[str, ...] = ()


@dataclass(frozen=True)
class Input:
    """Files in an empty folder, and what is done with them there.

    Attributes:
        files: Contents by name, or what writes them.
        act: Arguments of the command, or what is called in Python.
    """

    files: Mapping[str, Content]
    act: Sequence[str] | Callable[[], Any]


@dataclass(frozen=True)
class Draft:
    """A sound input and the changes to be made of it.

    Attributes:
        changes: Some changes; any part of them makes an input.
        made: Returns the input with some of the changes.
    """

    changes: tuple[Change, ...]
    made: Callable[[Sequence[Change]], Input] = field(repr=False)

    @property
    def name(self) -> str:
        """What is changed, in one line."""
        return "; ".join(change.name for change in self.changes) or "nothing changed"


def problem_of(draft: Draft, folder: Path) -> str | None:
    """Return what must not come of an input but does; None if all is as it must be.

    Args:
        draft: What to try, with all its changes.
        folder: An empty one, to work in.
    """
    wrong = len(draft.changes) == 1 and draft.changes[0].wrong
    before = os.getcwd()
    try:
        made = draft.made(draft.changes)
        for name, content in made.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if callable(content):
                content(path)
            else:
                path.write_bytes(
                    content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content
                )
        os.chdir(folder)
        refusal = _called(made.act) if callable(made.act) else _commanded(made.act, folder)
    except _FaultError as fault:
        return str(fault)
    except BaseException as error:
        return f"{type(error).__name__}: {error} ({_where(error)})"
    finally:
        os.chdir(before)
    if refusal is None:
        return "not refused" if wrong else None
    says = draft.changes[0].says if wrong else ()
    if says and not any(one in refusal for one in says):
        return f"the refusal names none of {', '.join(says)}: {refusal[:300]!r}"
    return None


class _FaultError(Exception):
    """What must never come of an input, in words."""


def _commanded(words: Sequence[str], folder: Path) -> str | None:
    """Give a command; return the line that it was refused with, or None."""
    before = {path.relative_to(folder) for path in folder.rglob("*")}
    out, err = io.StringIO(), io.StringIO()
    code: Any = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _as_errors():
        try:
            app(list(words), prog_name="antenna-pin")
        except SystemExit as ended:
            code = ended.code or 0
    said = err.getvalue()
    if code == _REFUSED and "--check" in words and not said:  # it tells of many files
        told = out.getvalue() + "".join(_texts(folder, words))
        said = "\n".join(line for line in told.splitlines() if "refused: " in line)
    if code == _REFUSED:
        lines = said.splitlines()
        for line in lines[:-1]:
            if not _NOTE.match(line):
                raise _FaultError(f"not one plain line: {said[:400]!r}")
        left = {path.relative_to(folder) for path in folder.rglob("*")} - before
        if left and not _may_leave(words):
            raise _FaultError(f"refused, and left {', '.join(map(str, left))}: {said[:200]!r}")
        return _line(lines[-1] if lines else "")
    if code not in (_DONE, _EARLY, _UNBALANCED, _DOUBTFUL):
        raise _FaultError(f"exit code {code}, said {(said or out.getvalue())[-300:]!r}")
    lines = said.splitlines() if code != _UNBALANCED else []
    for line in lines:
        if not _NOTE.match(line):
            raise _FaultError(f"exit code {code}, said {line!r}")
    return None


def _texts(folder: Path, words: Sequence[str]) -> Iterator[str]:
    """Yield what was written to the file behind ``--out``."""
    for option, value in itertools.pairwise(words):
        if option == "--out" and (folder / value).is_file():
            yield (folder / value).read_text(encoding="utf-8")


def quietly(words: Sequence[str], folder: Path) -> None:
    """Give a command that must be done, in a folder."""
    before = os.getcwd()
    os.chdir(folder)
    err = io.StringIO()
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(err):
            app(list(words), prog_name="antenna-pin")
    except SystemExit as ended:
        if ended.code not in (_DONE, _EARLY, None):
            raise ValueError(f"{' '.join(words)}: {err.getvalue()}") from None
    finally:
        os.chdir(before)


def _may_leave(words: Sequence[str]) -> bool:
    """Whether a command keeps what was done before it was refused: runs, or what is said of files."""
    return words[0] in ("sweep", "figures", "bifurcation") or "--check" in words


def _called(act: Callable[[], Any]) -> str | None:
    with _as_errors():
        try:
            act()
        except AntennaPinError as error:
            return _line(str(error))
    return None


@contextlib.contextmanager
def _as_errors() -> Any:
    """Let what NumPy and Python warn of be errors; what the package itself has to say of a run is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("always", category=UserWarning)
        warnings.filterwarnings("ignore", category=DeprecationWarning)
        yield


def _line(said: str) -> str:
    if len(said.splitlines()) != 1 or printable(said) != said:
        raise _FaultError(f"not one plain line: {said[:300]!r}")
    if len(said) > LINE:
        raise _FaultError(f"a line of {len(said)} letters: {said[:200]!r}")
    return said


def _where(error: BaseException) -> str:
    """Return the place of the package's own where an error came from."""
    place, trace = "", error.__traceback__
    while trace is not None:
        path = Path(trace.tb_frame.f_code.co_filename)
        if "antenna_pin" in path.parts or not place:
            place = f"{path.name}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place
