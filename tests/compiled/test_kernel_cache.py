"""Machine code that is kept: read as it was written, or compiled anew."""

import errno
import importlib.util
import os
import pickle
import subprocess
import sys
import warnings
from types import SimpleNamespace

import numba
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.compiled import jit
from antenna_pin.compiled import kernel_cache as _kernel_cache
from antenna_pin.compiled.compile_time import told_of_compiling
from antenna_pin.compiled.kernel_cache import KernelCacheWarning, keep
from antenna_pin.compiled.stand_alone import kernel_named, needs_of
from antenna_pin.compiled.target import baseline_runs

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

_SOURCE = "def twice(x):\n    return 2 * x\n"


@pytest.fixture
def source(tmp_path, monkeypatch):
    monkeypatch.setattr(_kernel_cache, "_told", [])
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")  # beside the source, wherever else tests keep theirs
    path = tmp_path / "kernels.py"
    path.write_text(_SOURCE)
    return path


def compiled(source, stamp="stamp"):
    """Return the function of a file as another process would have it."""
    spec = importlib.util.spec_from_file_location("kernels", source)
    module = importlib.util.module_from_spec(spec)
    sys.modules["kernels"] = module
    spec.loader.exec_module(module)
    function = numba.njit(module.twice)
    keep(function, stamp)
    return function


def hits(function):
    return sum(function.stats.cache_hits.values())


def files(source, suffix):
    return sorted((source.parent / "__pycache__").glob(f"*{suffix}"))


def test_machine_code_is_kept_for_the_next_process_and_for_the_same_stamp(source):
    first = compiled(source)
    assert (first(2), hits(first)) == (4, 0)
    again = compiled(source)
    assert (again(2), hits(again)) == (4, 1)
    other = compiled(source, "another stamp")
    assert (other(2), hits(other)) == (4, 0)


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[: len(content) // 2],
        lambda content: content[:-1],
        lambda content: bytes([*content[:40], content[40] ^ 1, *content[41:]]),
        lambda content: pickle.dumps("another version"),
        lambda content: os.urandom(len(content)),
    ],
    ids=["empty", "half", "cut", "flipped", "other", "random"],
)
def test_what_is_damaged_is_compiled_and_kept_anew(source, suffix, damage):
    compiled(source)(2)
    (path,) = files(source, suffix)
    path.write_bytes(damage(path.read_bytes()))
    anew = compiled(source)
    assert (anew(2), hits(anew)) == (4, 0)
    again = compiled(source)
    assert (again(2), hits(again)) == (4, 1)


@pytest.mark.skipif(not baseline_runs(), reason="this processor is older than the baseline")
def test_a_setting_of_numba_that_changes_later_leaves_the_processor(source, monkeypatch):
    """Numba reads all its settings anew when a variable of its own changes."""
    monkeypatch.delenv("NUMBA_CPU_NAME", raising=False)
    for level in ("2", "3"):
        monkeypatch.setenv("NUMBA_OPT", level)
        one = compiled(source, level)
        assert one(2) == 4
        assert len(list(_kernel_cache.stored_code(source, level))) == 1


def test_an_entry_of_other_arguments_is_not_taken(source):
    """Two processes that compile at once may give one name to two entries."""
    both = compiled(source)
    assert both(2) == 4
    assert both(2.5) == 5.0
    one, other = files(source, ".nbc")
    one.write_bytes(other.read_bytes())
    again = compiled(source)
    assert (again(2), again(2.5), hits(again)) == (4, 5.0, 1)


def test_where_nothing_can_be_kept_it_works_and_is_said_once(source, monkeypatch):
    """Neither folder can be written: as for a user without a home of a package that is not hers."""
    monkeypatch.setattr(_kernel_cache.FunctionCache._impl_class, "_locator_classes", [], raising=True)
    with pytest.warns(KernelCacheWarning, match="cannot be cached .* set NUMBA_CACHE_DIR") as told:
        assert compiled(source)(2) == 4
        assert compiled(source)(2.5) == 5.0
    assert len(told) == 1


def test_a_disk_that_fills_up_while_kernels_are_kept_costs_nothing_but_time(source, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(_kernel_cache._SealedFiles, "_write", full)
    with pytest.warns(KernelCacheWarning, match="No space left on device"):
        assert compiled(source)(2) == 4


def test_what_stands_beside_the_sources_is_read_by_those_who_cannot_write_there(
    source, tmp_path, monkeypatch
):
    compiled(source)(2)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "own"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shared = compiled(source)
        assert (shared(2), hits(shared)) == (4, 1)
    assert not [path for path in (tmp_path / "own").rglob("*.nb?")]


@pytest.mark.parametrize("whose", ["folder", "file", "way", "sticky folder", "other owner"])
def test_what_a_stranger_may_have_written_is_not_read(source, monkeypatch, whose):
    """A pickle runs code: it is read from where nobody else can have put it, also under NUMBA_CACHE_DIR."""
    if whose == "other owner" and os.geteuid() != 0:
        pytest.skip("only root can give a folder away")
    kept = source.parent / "on the way" / "kept"
    kept.mkdir(parents=True, mode=0o755)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(kept))
    first = compiled(source)
    first(2)
    (index,) = kept.rglob("*.nbi")
    again = compiled(source)
    assert (again(2), hits(again)) == (4, 1)
    opened = {"file": index, "way": kept.parent}.get(whose, index.parent)
    if whose == "other owner":
        os.chown(opened, 12345, -1)
    else:
        opened.chmod(0o1777 if whose == "sticky folder" else 0o777)
    _kernel_cache._closed.cache_clear()
    said = pytest.warns(
        KernelCacheWarning, match=r"is not safe, for .* remove the others' write permission, or set"
    )
    with warnings.catch_warnings() if whose == "file" else said:
        now = compiled(source)
        assert (now(2), hits(now)) == (4, 0)
    if whose == "way":
        opened.chmod(0o1777)  # as /tmp: nobody moves what is another's
        _kernel_cache._closed.cache_clear()
        now = compiled(source)
        assert (now(2), hits(now)) == (4, 1)


def test_who_waits_is_told_of_what_is_compiled(source):
    """Of a kernel that no file holds, once; and of nothing where it is read."""
    heard = []
    with told_of_compiling(lambda: heard.append(1)):
        first = compiled(source)
        assert first(1) == first(2) - 2 == 2
        assert heard == [1]
        assert compiled(source)(1) == 2
        assert heard == [1]
    assert first(1.0) == 2.0
    assert heard == [1]


_PAIR = """\
import numba
from antenna_pin.compiled.kernel_cache import keep
from antenna_pin.compiled.stand_alone import stand_alone
def own(x):
    return 2 * x
own = numba.njit(own)
keep(own, "stamp")
stand_alone(own)
def caller(x):
    return own(x) + 1
caller = numba.njit(caller)
keep(caller, "stamp")
"""

_ASKED = """\
import sys
sys.path.insert(0, sys.argv[1])
from kernels import caller, own
print(caller(3), sum(caller.stats.cache_hits.values()), sum(own.stats.cache_hits.values()))
"""


@pytest.fixture
def answer(source, monkeypatch):
    """Return what a process prints that calls the pair."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    def answered(text=_PAIR, more=""):
        source.write_text(text)
        # -B: bytecode of a text written in the same second, as long, would be taken for this one's.
        command = [sys.executable, "-B", "-c", _ASKED + more, str(source.parent)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
        return done.stdout.split()

    return answered


def test_a_kernel_that_stands_alone_is_found_by_callers_that_are_loaded(source, answer):
    """In another process: in the caller's pack, in its own file, or compiled anew if both are damaged.

    What is called by another stamp's name is other code.
    """
    assert answer() == ["7", "0", "0"]
    code = [path for path in (source.parent / "__pycache__").iterdir() if ".nbi" not in path.name]
    whole = {path: path.read_bytes() for path in code}
    for damaged, own_is_read in (((".own.py",), "0"), ((".nbp",), "1"), ((".own.py", ".nbp"), "0")):
        for path, content in whole.items():
            path.write_bytes(content[:-40] if any(part in path.name for part in damaged) else content)
        assert answer() == ["7", "1", own_is_read]
    assert answer()[:2] == ["7", "1"]
    other = _PAIR.replace('"stamp"', '"other"').replace("2 * x", "4 * x")
    assert [answer(other)[0], answer(other)[0]] == ["13", "13"]


def test_a_kernel_that_was_linked_for_its_callers_can_be_called_itself(answer):
    """After them it is made callable from its own file; its code is in the process once."""
    more = "print(own(5), own(1.5), caller(1.5), sum(own.stats.cache_hits.values()))\n"
    assert answer(more=more) == ["7", "0", "0", "10", "3.0", "4.0", "0"]
    assert answer(more=more) == ["7", "1", "0", "10", "3.0", "4.0", "2"]


def test_what_is_kept_under_other_stamps_goes_when_something_is_kept(source, monkeypatch):
    """Of the module's other functions and of modules that are gone, but for what cannot be read."""
    monkeypatch.setattr(_kernel_cache, "_swept", set())
    compiled(source, "old")(2)
    folder = source.parent / "__pycache__"
    (index,) = files(source, ".nbi")
    old = [*files(source, ".nbi"), *files(source, ".nbc")]
    for path in old:  # as of a function that has moved to another line, and of another Python
        path.with_name(path.name.replace("twice-1.", "twice-9.")).write_bytes(path.read_bytes())
        other = path.name.replace("twice-1.", "twice-9.").replace(".py3", ".py2")
        path.with_name(other).write_bytes(path.read_bytes())
    for path in old:
        path.with_name(path.name.replace("kernels.", "gone.", 1)).write_bytes(path.read_bytes())
        path.with_name(path.name.replace("kernels.", "beside.", 1)).write_bytes(path.read_bytes())
    (source.parent / "beside.py").touch()  # another module, with a stamp of its own
    (folder / index.name.replace("twice-1.", "twice-8.").replace(".nbi", ".0123.nbp")).write_bytes(b"left")
    strange = [folder / index.name.replace("twice-1.", "strange-1.")]
    strange.append(strange[0].with_name(strange[0].name.replace(".nbi", ".1.nbc")))
    for path in strange:
        path.write_bytes(b"somebody else's")
    monkeypatch.setattr(_kernel_cache, "_swept", set())  # another process
    assert compiled(source, "new")(2) == 4
    left = {path.name for path in [*files(source, ".nbi"), *files(source, ".nbc"), *files(source, ".nbp")]}
    mine = {path.name for path in old}
    elsewhere = {name.replace("twice-1.", "twice-9.").replace(".py3", ".py2") for name in mine}
    beside = {name.replace("kernels.", "beside.", 1) for name in mine}
    assert left == mine | beside | elsewhere | {path.name for path in strange}
    again = compiled(source, "new")
    assert (again(2), hits(again)) == (4, 1)


def test_callers_hold_nothing_of_a_kernel_that_stands_alone():
    """Else its machine code would be made once more for each of them, at ten times the time in all."""
    evaluate = importlib.import_module("antenna_pin.dynamics.kernels").evaluate
    attempt = importlib.import_module("antenna_pin.run.engine.step_kernels").attempt
    scenario = load_scenario(
        "bai2020",
        case="case3",
        overrides=["clearance.elevation.geometry=closed-form", "integrator.engine=compiled"],
    )
    simulate(scenario, duration=1e-3)
    go_on = importlib.import_module("antenna_pin.run.engine.loop_kernels").go_on
    left, seen = list(go_on._entry.overloads.values()), set()
    while left:  # what is linked for its callers has no bitcode here before it is asked for
        for name, arguments in needs_of(left.pop().library) - seen:
            seen.add((name, arguments))
            kernel_named(name).compile(arguments)
            left.append(kernel_named(name).overloads[arguments])
    assert attempt.overloads and evaluate.overloads
    for result in attempt.overloads.values():
        text = result.library._get_module_for_linking().as_bitcode()
        for called in evaluate.overloads.values():
            assert called.fndesc.mangled_name.encode() not in text
            assert b"antenna_pin.dynamics.kernels:evaluate:" in text


def test_words_and_places_are_not_what_code_is_tied_to(source):
    """A docstring, a comment or an annotation compiles nothing anew; a number does."""
    code = jit.code_of(_SOURCE)
    worded = '"""Kernels."""\n# Why.\ndef twice(x: float) -> float:\n    """Return it."""\n    return 2 * x\n'
    assert jit.code_of(worded) == code != jit.code_of(_SOURCE.replace("2", "3"))
    record = "class Spring:\n    stiffness: float\n"
    assert jit.code_of(record) != jit.code_of(record.replace("float", "int"))
    packed = "class Spring:\n    @packed\n    def limit(self) -> float:\n        return 2.0\n"
    assert jit.code_of(packed) == jit.code_of(packed.replace("2.0", "3.0"))
    for part, other in (("limit", "largest"), ("float", "int"), ("packed", "property")):
        assert jit.code_of(packed) != jit.code_of(packed.replace(part, other))
    compiled(source)(2)
    source.write_text(worded)
    again = compiled(source)
    assert (again(2), hits(again)) == (4, 1)


def test_a_kernel_is_tied_to_what_its_file_imports_and_no_more(tmp_path, monkeypatch):
    """Of a kind's file only to its kernels and fields; callers of kinds by their numbers to none of them."""
    compiled_room, kinds = tmp_path / "compiled", tmp_path / "elements"
    texts = {
        compiled_room / "jit.py": "",
        compiled_room / "lanes.py": "width = 4\n",
        kinds
        / "spring.py": "class Spring:\n    k: float = parameter('N/m')\ndef force(x):\n    return 2 * x\n",
        kinds / "kernels.py": f"from {tmp_path.name}.elements import registry\n",
        kinds / "gear.py": f"from {tmp_path.name}.elements import spring\n",
        tmp_path / "step_kernels.py": f"from {tmp_path.name}.elements.kernels import chain\n",
        tmp_path / "other_kernels.py": "one = 1\n",
    }
    monkeypatch.setattr(jit, "__file__", str(compiled_room / "jit.py"))

    def stamps(path=None, old="", new=""):
        changed = {one: text.replace(old, new) if one == path else text for one, text in texts.items()}
        assert changed != texts or path is None
        bytes_of = {one: text.encode() for one, text in list(changed.items())[1:]}
        return dict(zip([*(one.name for one in bytes_of), "all"], jit._digests(b"", bytes_of), strict=True))

    def differ(*change):
        return {name for name, stamp in stamps(*change).items() if stamp != before[name]}

    before = stamps()
    assert differ(tmp_path / "other_kernels.py", "1", "2") == {"other_kernels.py", "all"}
    kept = differ(kinds / "spring.py", "2 * x", "3 * x")
    assert kept == {"spring.py", "gear.py", "all"}
    assert kept == differ(kinds / "spring.py", "k: float", "c: float")
    assert differ(kinds / "spring.py", "'N/m'", "'N/mm'") == set()
    assert differ(compiled_room / "lanes.py", "4", "8") == set(before)


def test_a_text_that_follows_from_files_is_made_once(source):
    function, made = compiled(source).py_func, []

    def make():
        made.append("text")
        return "text"

    for contents, times in (("old", 1), ("old", 1), ("new", 2)):
        assert _kernel_cache.remembered(function, contents, make) == "text"
        assert len(made) == times
    for path in files(source, ".nbc"):
        path.write_bytes(path.read_bytes()[:-1])
    assert _kernel_cache.remembered(function, "new", make) == "text" and len(made) == 3


def test_code_of_the_family_is_looked_for_behind_that_of_the_processor(source, monkeypatch):
    """As installed code is, where a script has had Numba compile for the processor at hand."""
    own = SimpleNamespace(magic_tuple=lambda: ("x86_64-linux", "znver4", "+avx512f"))
    cache = compiled(source)._cache
    for runs, targets in (
        (True, [("znver4", "+avx512f"), ("x86-64-v3", "")]),
        (False, [("znver4", "+avx512f")]),
    ):
        monkeypatch.setattr(_kernel_cache, "baseline_runs", lambda runs=runs: runs)
        assert [key[1] for key in cache._keys((), own)] == [("x86_64-linux", *one) for one in targets]
