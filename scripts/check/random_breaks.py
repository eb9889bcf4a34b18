#!/usr/bin/env python3
"""Break the package at random, one small change at a time, and see whether the tests of the room notice.

    scripts/check/random_breaks.py --count 300 --seed 0       an hour on two cores; rooms take turns
    scripts/check/random_breaks.py --count 5 --room fit       in one room
    scripts/check/random_breaks.py --count 300 --list         what would be broken, and run nothing
    scripts/check/random_breaks.py --only 17 40               some of those, by their numbers
    scripts/check/random_breaks.py --again KEPT.json          those that were kept (--keep), where they are

Numbers, signs, comparisons, indices, units, factors and arguments are changed where a room's Python has them
(``break_sites.py``). A break is run against the tests that are not slow in ``tests/ROOM``, of a command in
those of its room too. Which of them run a line is found first, by one run of all tests in a copy with probes
(``break_hits.py``; ``--map FILE`` keeps it for the next time); where no probe can stand, as in what is run at
import and in kernels, those files come first that name something of the broken module, then all others. It is
*killed* if one fails, *lived* if all pass, *unreached* if there are none, *unclear* if the time ran out,
*equivalent* if ``random_breaks.toml`` says why nothing can notice it, *gone* if the line that was drawn is.
What lives becomes a test, or the line goes. Each break is made in a copy of the tree in a temporary folder.
Kernels run as plain Python where one of their files is broken, so that nothing is compiled.
Exit code 1 if one in ten or more lived or was not reached.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import break_hits
from break_sites import TOP, Break, draw, found_again, rooms

ROOT = Path(__file__).resolve().parents[2]
EQUIVALENT = Path(__file__).with_suffix(".toml")
#: Imported once, before a process is made for each run of tests.
PRELOADED = ("numpy", "scipy.optimize", "scipy.signal", "xarray", "numba", "pinocchio", "pydantic", "pytest")


def test_files(tree: Path, broken: Break) -> tuple[list[str], list[str]]:
    """Return the test files of a break that name something of its module, and the others of its room."""
    own = [one for folder in folders_of(broken) for one in sorted((tree / folder).rglob("test_*.py"))]
    top = sorted((tree / "tests").glob("test_*.py"))
    names = {broken.path.stem.removesuffix("_kernels"), *broken.names}
    pattern = re.compile(rf"\b(?:{'|'.join(map(re.escape, sorted(names)))})\b")

    def named(files: list[Path]) -> list[str]:
        found = [(len(pattern.findall(file.read_text(encoding="utf-8"))), file) for file in files]
        found.sort(key=lambda one: (-one[0], one[1]))
        return [str(file.relative_to(tree)) for count, file in found if count]

    first = named(own) + (named(top) if not own else [])
    rest = [str(file.relative_to(tree)) for file in own]
    return first, [name for name in rest if name not in first]


def folders_of(broken: Break) -> tuple[str, ...]:
    """Return where the tests are that a break is tried on."""
    if broken.room == TOP:
        return ("tests/test_",)
    own = [f"tests/{broken.room}/"]
    if broken.room == "cli":  # a command is tested beside the room that it is a face of
        own.append(f"tests/{broken.path.stem}/")
    return tuple(own)


def run_tests(tree: Path, files: list[str], plain: bool, timeout: float) -> int | None:
    """Return pytest's exit code on test files in a process of its own; None if it took too long."""
    child = os.fork()
    if child == 0:
        os.setsid()
        os.chdir(tree)
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        os.environ |= {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
        os.environ["NUMBA_DISABLE_JIT"] = str(int(plain))
        os.environ.setdefault("ANTENNA_PIN_TEST_BROWSER", "skip")
        sys.dont_write_bytecode = True
        sys.path.insert(0, str(tree))
        import numba
        import pytest

        numba.config.DISABLE_JIT = int(plain)
        code = 99
        try:
            code = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-n", "0", *files]))
        finally:
            os._exit(code)
    until = time.monotonic() + timeout
    while time.monotonic() < until:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.05)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def verdict(
    tree: Path,
    broken: Break,
    equivalent: dict[tuple[str, str, str], str],
    timeout: float,
    tests: list[str] | None = None,
) -> str:
    """Make a break in the tree, run the tests that run it or of its room, and put the tree right again."""
    if broken.key in equivalent:
        return "equivalent"
    path = tree / broken.path
    text, stat = path.read_text(encoding="utf-8"), path.stat()
    groups = test_files(tree, broken) if tests is None else (tests,)
    if not any(groups):
        return "unreached"
    path.write_text(broken.made(text), encoding="utf-8")
    until = time.monotonic() + timeout
    try:
        for files in groups:
            left = until - time.monotonic()
            code = run_tests(tree, files, broken.plain, max(left, 1.0)) if files else 5
            if code is None:
                return "unclear"
            if code not in (0, 5):  # all passed; nothing there
                return "killed"
    finally:
        path.write_text(text, encoding="utf-8")
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    return "lived"


def copied(folder: Path) -> Path:
    """Return a copy of the tree in a folder."""
    leave = shutil.ignore_patterns(".git", ".*_cache", ".venv", "dist", "build")
    shutil.copytree(ROOT, folder / "tree", ignore=leave, symlinks=True)
    return folder / "tree"


def found_hits(folder: Path, drawn: Sequence[Break | None], workers: int) -> break_hits.Hits:
    """Run all tests that are not slow in a copy with probes, and return what runs what."""
    tree, written = copied(folder), folder / "hits"
    written.mkdir()
    numbers = break_hits.put_probes(tree, ((k, one) for k, one in enumerate(drawn, 1) if one))
    print(f"{len(numbers)} of {len(drawn)} places have probes; all tests are run once", flush=True)
    env = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(tree), str(Path(__file__).parent)]),
        "PYTHONDONTWRITEBYTECODE": "1",
        break_hits.FOLDER: str(written),
    }
    env.setdefault("ANTENNA_PIN_TEST_BROWSER", "skip")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "break_hits", "-p", "no:cacheprovider"]
    command += ["-n", str(workers), "--dist", "worksteal"]
    with open(folder / "tests.txt", "w", encoding="utf-8") as log:
        subprocess.run(command, cwd=tree, env=env, stdout=log, stderr=subprocess.STDOUT, check=False)
    lines = (folder / "tests.txt").read_text(encoding="utf-8").rstrip().splitlines()
    # Some may fail for a probe's line: what reads sources, what runs without the tree's path.
    print(*[line for line in lines if line.startswith(("FAILED", "ERROR"))], lines[-1], sep="\n", flush=True)
    return break_hits.Hits.read(written, numbers)


def work(
    numbers: multiprocessing.SimpleQueue[int | None],
    verdicts: multiprocessing.SimpleQueue[tuple[int, str, float] | None],
    drawn: list[Break | None],
    hits: break_hits.Hits,
    timeout: float,
) -> None:
    """Try breaks by their numbers in a copy of this process's own until there are no more."""
    tables = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["equivalent"]
    equivalent = {(one["file"], one["old"], one["new"]): one["why"] for one in tables}
    for name in PRELOADED:
        __import__(name)
    with tempfile.TemporaryDirectory(prefix="breaks-") as folder:
        tree = copied(Path(folder))
        while (number := numbers.get()) is not None:
            broken, began = drawn[number - 1], time.monotonic()
            if broken is None:
                verdicts.put((number, "gone", 0.0))
                continue
            # What only runs while tests are collected is credited to none.
            tests = hits.tests(number, folders_of(broken)) or None if number in hits.of else None
            found = verdict(tree, broken, equivalent, timeout, tests)
            verdicts.put((number, found, time.monotonic() - began))
    verdicts.put(None)


def main() -> int:
    """Run the breaks that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--count", type=int, default=30, help="how many to draw")
    parser.add_argument("--seed", type=int, default=0, help="of the draw")
    parser.add_argument("--room", choices=rooms(ROOT), help="draw from one room only")
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="run these of the drawn ones")
    parser.add_argument("--list", action="store_true", help="print what is drawn, and run nothing")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="write what is drawn, and run nothing")
    parser.add_argument("--again", type=Path, metavar="FILE", help="run what was drawn and kept")
    parser.add_argument("--map", type=Path, metavar="FILE", help="which tests run what: read, or written")
    parser.add_argument("--timeout", type=float, default=900.0, help="of the tests of one break [s]")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes side by side")
    asked = parser.parse_args()
    drawn: list[Break | None] = [*draw(ROOT, asked.count, asked.seed, asked.room)]
    if asked.again:
        kept = json.loads(asked.again.read_text(encoding="utf-8"))
        drawn = [found_again(ROOT, one) for one in kept]
    if asked.keep:
        lines = [json.dumps(one.kept(ROOT)) for one in drawn if one]  # a line for each break
        asked.keep.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")
        return 0
    numbers = asked.only or list(range(1, len(drawn) + 1))
    if not all(1 <= number <= len(drawn) for number in numbers):
        parser.error(f"--only must be of 1 to {len(drawn)}")
    if asked.list:
        for number in numbers:
            print(f"{number:4}  {drawn[number - 1]}")
        return 0
    if asked.map and asked.map.exists():
        hits = break_hits.Hits.load(asked.map)
    else:
        with tempfile.TemporaryDirectory(prefix="breaks-") as folder:
            hits = found_hits(Path(folder), drawn, asked.workers)
        if asked.map:
            hits.save(asked.map)
    seen: Counter[str] = Counter()
    todo: multiprocessing.SimpleQueue[int | None] = multiprocessing.SimpleQueue()
    verdicts: multiprocessing.SimpleQueue[tuple[int, str, float] | None] = multiprocessing.SimpleQueue()
    arguments = (todo, verdicts, drawn, hits, asked.timeout)
    workers = [multiprocessing.Process(target=work, args=arguments) for _ in range(asked.workers)]
    for worker in workers:
        worker.start()
    for number in [*numbers, *[None] * len(workers)]:
        todo.put(number)
    left = len(workers)
    while left:
        one = verdicts.get()
        if one is None:
            left -= 1
            continue
        number, found, seconds = one
        seen[found] += 1
        print(f"{number:4}  {found:10} {seconds:4.0f} s  {drawn[number - 1]}", flush=True)
    for worker in workers:
        worker.join()
    print(", ".join(f"{count} {name}" for name, count in sorted(seen.items())))
    lived = seen["lived"] + seen["unreached"]
    return int(10 * lived >= max(1, lived + seen["killed"]))


if __name__ == "__main__":
    sys.exit(main())
