"""Samples on the disk: sealed files in a folder beside the result, and all samples block by block.

``NAME.nc.parts`` has parts of samples, written once each, and one checkpoint, which is replaced. A part that
no checkpoint lists yet is written anew after a kill.
"""

from __future__ import annotations

import contextlib
import fcntl
import math
import os
import re
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.capacity import check_fits
from antenna_pin.base.files import has_whole_seal, replacing, seal
from antenna_pin.base.records import MEMORY
from antenna_pin.base.units import shown
from antenna_pin.errors import FileFormatError, OutputError
from antenna_pin.simulation.samples import Chunk, LateSample, Samples

__all__ = [
    "CHECKPOINT",
    "LATE",
    "SAMPLED",
    "SampleFiles",
    "blocks_of",
    "changed_words",
    "chunk_of",
    "count_of",
    "folder_of",
    "late_numbers",
    "late_of",
    "numbers_of",
    "read_sealed",
    "words_of",
    "write_sealed",
]

Array = NDArray[np.float64]

#: Name of the file that is written after the parts that it tells of.
CHECKPOINT = "checkpoint"

#: Arrays of samples, and of late ones, in a file.
SAMPLED = ("times", "states", "memories", "program", "programs", "changed", "values")
LATE = ("late_times", "late_states", "late_memories")

_SUFFIX = ".parts"
_PART = re.compile("|".join(("run", *SAMPLED)))
_MEMBER = ".npy"


def folder_of(path: str | os.PathLike[str]) -> Path:
    """Return the folder of parts of a run whose result is a file; that folder may be named itself."""
    path = Path(path)
    return path if path.suffix == _SUFFIX else path.with_name(path.name + _SUFFIX)


def write_sealed(path: Path, numbers: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as one file, whole or not at all.

    Raises:
        OutputError: It cannot be written there.
    """
    with replacing(path) as partial:
        with partial.open("wb") as file:
            np.savez(file, allow_pickle=False, **dict(numbers))
        seal(partial)


def read_sealed(path: Path, known: re.Pattern[str]) -> dict[str, NDArray[Any]]:
    """Return the arrays of a file.

    Args:
        path: Of the file.
        known: Matches the names that its arrays may have.

    Raises:
        FileFormatError: It is not there, or not as it was written; nothing is read of what is not known, is
            there twice, or would take more memory than its bytes in the file.
    """
    way_out = "run the scenario again from its start"
    try:
        if not has_whole_seal(path):
            raise FileFormatError(
                f"{path}: must be as antenna-pin wrote it, got another checksum: it was damaged; {way_out}"
            )
        with zipfile.ZipFile(path) as file:
            _check_members(file, path.stat().st_size, known)
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except FileFormatError:
        raise
    except FileNotFoundError:
        raise FileFormatError(f"{path}: no such file; {way_out}") from None
    except (OSError, ValueError, KeyError, EOFError, MemoryError, zipfile.BadZipFile) as error:
        words = " ".join(str(error).split())
        raise FileFormatError(f"{path}: must be what antenna-pin wrote, got: {words}; {way_out}") from None


def _check_members(file: zipfile.ZipFile, size: int, known: re.Pattern[str]) -> None:
    """Refuse arrays that are not known, are there twice, or take more memory than bytes in the file."""
    members = file.infolist()
    if any(one.compress_type != zipfile.ZIP_STORED for one in members) or (
        sum(one.file_size for one in members) > size
    ):
        raise ValueError(f"packed arrays of more bytes than the {size} of the file")
    names = [one.filename for one in members]
    for one in members:
        if not (one.filename.endswith(_MEMBER) and known.fullmatch(one.filename.removesuffix(_MEMBER))):
            raise ValueError(f"{shown(one.filename)}, which is not known")
        if names.count(one.filename) > 1:
            raise ValueError(f"{one.filename} {names.count(one.filename)} times")
        with file.open(one) as stream:
            np.lib.format.read_magic(stream)  # of another version's header what follows makes no sense
            shape, _, kind = np.lib.format.read_array_header_1_0(stream)
            if min(shape, default=0) < 0 or stream.tell() + math.prod(shape) * kind.itemsize != one.file_size:
                raise ValueError(f"{one.filename} of shape {shape} in {one.file_size} bytes")


# --- samples in numbers ---------------------------------------------------------------------------------


def words_of(program: Array) -> NDArray[np.int64]:
    """Return a program's words as they are in memory; a view.

    Some are integers, which as floats may be NaN: those are not equal to themselves, and lose bits as text.
    """
    return program.view(np.int64)


def changed_words(program: Array, base: Array) -> list[int]:
    """Return which words of a program differ from another's."""
    return np.flatnonzero(words_of(program) != words_of(base)).tolist()


def numbers_of(chunk: Chunk, base: Array) -> dict[str, NDArray[Any]]:
    """Return samples as arrays for a file; of programs what differs from the system's own.

    Programs hold addresses of compiled functions, too, which are other ones in each process.
    """
    which = np.zeros(len(chunk.times), dtype=np.uint32)
    distinct: list[Array] = []
    for k, program in enumerate(chunk.programs):
        if not distinct or program is not distinct[-1]:
            distinct.append(program)
        which[k] = len(distinct) - 1
    changes = [(k, word) for k, program in enumerate(distinct) for word in changed_words(program, base)]
    return {
        "times": chunk.times,
        "states": chunk.states,
        "memories": chunk.memories,
        "program": which,
        "programs": np.array(len(distinct)),
        "changed": np.array(changes, dtype=np.int64).reshape(-1, 2),
        "values": np.array([words_of(distinct[k])[word] for k, word in changes], dtype=np.int64),
    }


def chunk_of(numbers: Mapping[str, NDArray[Any]], base: Array) -> Chunk:
    """Return the samples that :func:`numbers_of` has made arrays of.

    Raises:
        ValueError: They are no such samples.
        TooLargeError: Their programs do not fit into memory.
    """
    count, which, changed = int(numbers["programs"]), numbers["program"], numbers["changed"]
    if not 0 <= count <= len(which) == len(numbers["times"]) or (which >= count).any():
        raise ValueError(f"{len(which)} samples with one of {count} programs each")
    if changed.size and (changed.min() < 0 or (changed.max(axis=0) >= (count, len(base))).any()):
        raise ValueError(f"changes beyond {count} programs of {len(base)} words")
    check_fits("simulate", f"{count} programs", count * base.nbytes, "run the scenario again from its start")
    distinct = [base.copy() for _ in range(count)]
    for (k, word), value in zip(changed.tolist(), numbers["values"].tolist(), strict=True):
        words_of(distinct[k])[word] = value
    return Chunk(
        numbers["times"],
        numbers["states"],
        numbers["memories"],
        [distinct[k] for k in which.tolist()],
    )


def late_numbers(late: Iterable[LateSample], size: int, contacts: int) -> dict[str, NDArray[Any]]:
    """Return late samples as arrays."""
    late = list(late)
    memories = np.zeros((len(late), contacts), MEMORY)
    for k, one in enumerate(late):
        memories[k] = one.memory
    return {
        "late_times": np.array([one.time for one in late], dtype=float),
        "late_states": np.array([one.state for one in late], dtype=float).reshape(-1, size),
        "late_memories": memories,
    }


def late_of(numbers: Mapping[str, NDArray[Any]]) -> list[LateSample]:
    """Return the samples that :func:`late_numbers` has made arrays of."""
    rows = zip(numbers["late_times"].tolist(), numbers["late_states"], numbers["late_memories"], strict=True)
    return [LateSample(*row) for row in rows]


# --- the folder -----------------------------------------------------------------------------------------


class SampleFiles:
    """The parts of one run, in their folder.

    The folder is locked as long as this lives: two runs do not write into one.

    Args:
        folder: Where; made with the first file.
        base: The system's own program.
        identity: Of the run; parts of another are refused.

    Attributes:
        rows: Samples in each part.
    """

    def __init__(self, folder: Path, base: Array, identity: str) -> None:
        """Begin without parts."""
        self.folder = folder
        self.identity = identity
        self.rows: list[int] = []
        self._base = base
        self._lock: int | None = None

    def __enter__(self) -> Self:
        """Begin."""
        return self

    def __exit__(self, *error: object) -> None:
        """Unlock the folder."""
        self.close()

    def open(self) -> None:
        """Make and lock the folder.

        Raises:
            OutputError: It cannot be made, or another run writes into it.
        """
        if self._lock is not None:
            return
        try:
            self.folder.mkdir(exist_ok=True)
            self._lock = os.open(self.folder, os.O_RDONLY | os.O_CLOEXEC)
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be written: {error.strerror}") from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(self._lock)
            self._lock = None
            raise OutputError(
                f"{self.folder}: another run writes into it; wait for its end, or name another output"
            ) from None
        except OSError:  # a file system without locks
            pass

    def close(self) -> None:
        """Unlock the folder."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def path(self, number: int) -> Path:
        """Return where a part is."""
        return self.folder / f"{number:06d}.part"

    def append(self, chunk: Chunk) -> None:
        """Write a part.

        Raises:
            OutputError: It cannot be written there.
        """
        self.open()
        numbers = numbers_of(chunk, self._base)
        write_sealed(self.path(len(self.rows)), {"run": np.array(self.identity), **numbers})
        self.rows.append(len(chunk.times))

    def read(self, number: int) -> Chunk:
        """Return a part.

        Raises:
            FileFormatError: It is not as it was written, or of another run.
        """
        path = self.path(number)
        numbers = read_sealed(path, _PART)
        if str(numbers.get("run")) != self.identity or len(numbers["times"]) != self.rows[number]:
            raise FileFormatError(
                f"{path}: must be of the run of the checkpoint beside it, got a part of another; "
                "run the scenario again from its start"
            )
        return chunk_of(numbers, self._base)

    def drop_others(self) -> None:
        """Remove parts that were written after the checkpoint that the run goes on from."""
        for path in self.folder.glob("*.part"):
            if path not in {self.path(k) for k in range(len(self.rows))}:
                with contextlib.suppress(OSError):
                    path.unlink()

    def remove(self) -> None:
        """Remove the parts, the checkpoint and the folder."""
        if self.folder.is_dir():
            for path in [self.folder / CHECKPOINT, *self.folder.glob("*.part")]:
                with contextlib.suppress(OSError):
                    path.unlink()
            with contextlib.suppress(OSError):  # what others have put there stays
                self.folder.rmdir()
        self.close()


# --- all samples of a run, block by block -------------------------------------------------------------------

#: Samples of a block: few enough that all which they imply takes little room. Blocks are the same ones
#: however a record is spread over disk and memory, or round-off might tell.
BLOCK = 8192


def _chunks(samples: Samples, parts: SampleFiles | None) -> Iterator[Chunk]:
    if parts is not None:
        yield from map(parts.read, range(len(parts.rows)))
    yield samples.held


def _with_late(chunk: Chunk, late: Sequence[LateSample], samples: Samples) -> Chunk:
    """Return a chunk with late samples at their places; where there is one of their time that one stays."""
    there = set(chunk.times[np.searchsorted(chunk.times, [one.time for one in late])].tolist())
    new = [one for one in late if one.time not in there]
    if not new:
        return chunk
    places = np.searchsorted(chunk.times, [one.time for one in new])
    programs = list(chunk.programs)
    # What held at the sample before holds on to the next event.
    states = [one.state.copy() for one in new]
    for place, one, state in zip(places.tolist(), new, states, strict=True):
        samples.hold(one.time, state, programs[max(place - 1, 0)])
    for place, _ in sorted(zip(places.tolist(), new, strict=True), key=lambda one: -one[0]):
        programs.insert(place, programs[max(place - 1, 0)])
    return Chunk(
        np.insert(chunk.times, places, [one.time for one in new]),
        np.insert(chunk.states, places, states, axis=0),
        np.insert(chunk.memories, places, np.array([one.memory for one in new]), axis=0),
        programs,
    )


def _merged(samples: Samples, parts: SampleFiles | None) -> Iterator[Chunk]:
    first = {one.time: one for one in reversed(samples.late)}  # of those of one time the first
    late = [first[time] for time in sorted(first)]
    before: Chunk | None = None
    for chunk in _chunks(samples, parts):
        if not len(chunk.times):
            continue
        if late and late[0].time <= chunk.times[-1]:
            count = sum(one.time <= chunk.times[-1] for one in late)
            mine, late = late[:count], late[count:]
            if before is not None:  # whose last program goes on before this chunk's first sample
                chunk = Chunk.joined([before.part(-1, None), chunk])
            chunk = _with_late(chunk, mine, samples)
            if before is not None:
                chunk = chunk.part(1, None)
        before = chunk
        yield chunk


def blocks_of(samples: Samples, parts: SampleFiles | None = None) -> Iterator[Chunk]:
    """Yield the samples of a run, in blocks of :data:`BLOCK` and one of the rest.

    Args:
        samples: Those in memory.
        parts: Those before them.

    Raises:
        FileFormatError: A part is not as it was written.
    """
    waiting: list[Chunk] = []
    for chunk in _merged(samples, parts):
        waiting.append(chunk)
        count = sum(len(one.times) for one in waiting)
        if count < BLOCK:
            continue
        whole = Chunk.joined(waiting)
        for first in range(0, count - BLOCK + 1, BLOCK):
            yield whole.part(first, first + BLOCK)
        waiting = [whole.part(count - count % BLOCK, None)]
    rest = Chunk.joined(waiting)
    if len(rest.times):
        yield rest


def count_of(samples: Samples, parts: SampleFiles | None = None) -> int:
    """Return how many samples a run has."""
    if not samples.late:
        return len(samples.times) + (0 if parts is None else sum(parts.rows))
    return sum(len(chunk.times) for chunk in _merged(samples, parts))
