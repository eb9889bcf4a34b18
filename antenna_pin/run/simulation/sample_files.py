"""Samples on the disk: sealed files beside the result; all samples block by block.

``NAME.nc.parts`` has parts of samples, written once each, and one checkpoint, which is replaced. A part that
no checkpoint lists yet is written again after a kill.
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
from antenna_pin.run.simulation.samples import Chunk, LateSample, Samples

Array = NDArray[np.float64]

#: Name of the checkpoint's file, which is written after the parts that it lists.
CHECKPOINT = "checkpoint"

#: Arrays of samples, and of late ones, in a file.
SAMPLED = ("times", "states", "memories", "program", "programs", "changed", "values")
LATE = ("late_times", "late_states", "late_memories")

_SUFFIX = ".parts"
_PART = re.compile("|".join(("run", *SAMPLED)))
_MEMBER = ".npy"


def folder_of(path: str | os.PathLike[str]) -> Path:
    """Return the folder of parts of a result's file, or the folder itself."""
    path = Path(path)
    return path if path.suffix == _SUFFIX else path.with_name(path.name + _SUFFIX)


def write_sealed(path: Path, numbers: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as one file, whole or not at all.

    Raises:
        OutputError: The file cannot be written.
    """
    with replacing(path) as partial:
        with partial.open("wb") as file:
            np.savez(file, allow_pickle=False, **dict(numbers))
        seal(partial)


def read_sealed(path: Path, known: re.Pattern[str]) -> dict[str, NDArray[Any]]:
    """Return the arrays of a file.

    Args:
        path: Path of the file.
        known: Pattern of the names of its arrays.

    Raises:
        FileFormatError: The file is missing or damaged; nothing is read of an array that is unknown, is
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
    """Refuse arrays that are unknown, repeated, or larger than their bytes in the file."""
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
            np.lib.format.read_magic(stream)  # the header of another version cannot be read
            shape, _, kind = np.lib.format.read_array_header_1_0(stream)
            if min(shape, default=0) < 0 or stream.tell() + math.prod(shape) * kind.itemsize != one.file_size:
                raise ValueError(f"{one.filename} of shape {shape} in {one.file_size} bytes")


# --- samples in numbers ---------------------------------------------------------------------------------


def words_of(program: Array) -> NDArray[np.int64]:
    """Return the 8-byte words of a program as integers; a view.

    Some words are integers, which as floats may be NaN: unequal to themselves, and inexact as text.
    """
    return program.view(np.int64)


def changed_words(program: Array, base: Array) -> list[int]:
    """Return the places of words that differ between two programs."""
    return np.flatnonzero(words_of(program) != words_of(base)).tolist()


def numbers_of(chunk: Chunk, base: Array) -> dict[str, NDArray[Any]]:
    """Return samples as arrays for a file; of programs the differences from the system's.

    Programs also hold addresses of compiled functions, which differ between processes.
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
    """Return the samples of arrays from :func:`numbers_of`.

    Raises:
        ValueError: The arrays are no such samples.
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
    """Return the samples of arrays from :func:`late_numbers`."""
    rows = zip(numbers["late_times"].tolist(), numbers["late_states"], numbers["late_memories"], strict=True)
    return [LateSample(*row) for row in rows]


# --- the folder -----------------------------------------------------------------------------------------


class SampleFiles:
    """Parts of one run's record, in their folder.

    The folder stays locked: two runs do not write into one.

    Args:
        folder: Folder of the parts; made with the first file.
        identity: Identity of the run; parts of another run are refused.

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
        """Return the parts."""
        return self

    def __exit__(self, *error: object) -> None:
        """Unlock the folder."""
        self.close()

    def open(self) -> None:
        """Make and lock the folder.

        Raises:
            OutputError: The folder cannot be made, or another run writes into it.
        """
        if self._lock is not None:
            return
        try:
            self.folder.mkdir(exist_ok=True)
            self._lock = os.open(self.folder, os.O_RDONLY)
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
        """Return the path of a part."""
        return self.folder / f"{number:06d}.part"

    def append(self, chunk: Chunk) -> None:
        """Write a part.

        Raises:
            OutputError: The file cannot be written.
        """
        self.open()
        numbers = numbers_of(chunk, self._base)
        write_sealed(self.path(len(self.rows)), {"run": np.array(self.identity), **numbers})
        self.rows.append(len(chunk.times))

    def read(self, number: int) -> Chunk:
        """Return a part.

        Raises:
            FileFormatError: The part is damaged, or of another run.
        """
        path = self.path(number)
        numbers = read_sealed(path, _PART)
        if str(numbers.get("run")) != self.identity or len(numbers["times"]) != self.rows[number]:
            raise FileFormatError(
                f"{path}: must belong to the same run as its checkpoint, got a part of another run; run the "
                f"scenario again from the start"
            )
        return chunk_of(numbers, self._base)

    def drop_others(self) -> None:
        """Remove parts written after the checkpoint from which the run continues."""
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
            with contextlib.suppress(OSError):  # other files there stay
                self.folder.rmdir()
        self.close()


# --- all samples of a run, block by block -------------------------------------------------------------------

#: Samples of a block: few enough for the memory of all variables. Blocks are the same ones
#: however a record is spread over disk and memory, for the same round-off.
BLOCK = 8192


def _chunks(samples: Samples, parts: SampleFiles | None) -> Iterator[Chunk]:
    if parts is not None:
        yield from map(parts.read, range(len(parts.rows)))
    yield samples.chunk


def _with_late(chunk: Chunk, late: Sequence[LateSample], samples: Samples) -> Chunk:
    """Return a chunk with late samples inserted; existing samples of the same time stay."""
    there = set(chunk.times[np.searchsorted(chunk.times, [one.time for one in late])].tolist())
    new = [one for one in late if one.time not in there]
    if not new:
        return chunk
    places = np.searchsorted(chunk.times, [one.time for one in new])
    programs = list(chunk.programs)
    # The program of the previous sample is valid up to the next event.
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
    first = {one.time: one for one in reversed(samples.late)}  # of coincident ones the first
    late = [first[time] for time in sorted(first)]
    before: Chunk | None = None
    for chunk in _chunks(samples, parts):
        if not len(chunk.times):
            continue
        if late and late[0].time <= chunk.times[-1]:
            count = sum(one.time <= chunk.times[-1] for one in late)
            mine, late = late[:count], late[count:]
            if before is not None:  # its last program is valid up to this chunk's first sample
                chunk = Chunk.joined([before.part(-1, None), chunk])
            chunk = _with_late(chunk, mine, samples)
            if before is not None:
                chunk = chunk.part(1, None)
        before = chunk
        yield chunk


def blocks_of(samples: Samples, parts: SampleFiles | None = None) -> Iterator[Chunk]:
    """Yield the samples of a run in blocks of :data:`BLOCK`, and the rest.

    Raises:
        FileFormatError: A part is damaged.
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
    """Return the number of samples of a run."""
    if not samples.late:
        return len(samples.times) + (0 if parts is None else sum(parts.rows))
    return sum(len(chunk.times) for chunk in _merged(samples, parts))
