"""A run that was stopped, any number of times, and goes on from its checkpoints ends as if it never was."""

import io
import itertools
import json
import os
import re
import shutil
import signal
import warnings
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from interruptions import in_pieces, same

from antenna_pin import Outcome, RunSettings, Trajectory, load_scenario, simulate
from antenna_pin.base.files import seal
from antenna_pin.errors import AntennaPinError, FileFormatError, OutputError
from antenna_pin.run.simulation import (
    Checkpoint,
    CheckpointsWaitedWarning,
    Event,
    NotKeptWarning,
    Rate,
    Stop,
    checkpoint,
)
from antenna_pin.run.simulation import (
    run as run_module,
)
from antenna_pin.run.simulation.sample_files import read_sealed, write_sealed
from antenna_pin.scenario.assemble import build_system, initial_state

from .conftest import make_small

BRISTLES = (
    "clearance.elevation.friction={law='lugre', static=0.2, dynamic=0.1, stribeck_speed='1 mm/s',"
    " bristle_stiffness=1e5, replace=true}",
)
#: Checkpoints every 20 ms wait for each other where the machine is slow, and say so.
pytestmark = pytest.mark.filterwarnings("ignore::antenna_pin.run.simulation.CheckpointsWaitedWarning")

METHODS = ("rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853", "radau5")


def antenna(*overrides, geometry="closed-form", engine="pinocchio"):
    changes = [f"clearance.elevation.geometry={geometry}", f"integrator.engine={engine}", *overrides]
    return load_scenario(
        "bai2020", case="case3", overrides=["output.rate=20 kHz", "integrator.max_step=0.2 ms", *changes]
    )


CASES = {
    **{
        method: dict(overrides=(f"integrator.method={method}", "integrator.rtol=1e-6"))
        for method in ("dormand-prince-853", "radau5")
    },
    **{
        f"compiled {method}": dict(
            overrides=(f"integrator.method={method}", "integrator.rtol=1e-6"), engine="compiled"
        )
        for method in METHODS
    },
    "coal": dict(geometry="coal"),
    "coal, distributed": dict(overrides=("clearance.elevation.load=distributed",), geometry="coal"),
    "bristles": dict(overrides=BRISTLES),
    "bristles, compiled": dict(overrides=BRISTLES, engine="compiled"),
    "tsuji": dict(overrides=("clearance.elevation.normal={law='tsuji', restitution=0.8, replace=true}",)),
    "lean": dict(overrides=("output.form=lean",), engine="compiled"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_run_in_pieces_is_the_run_in_one(case, tmp_path, small_parts):
    """For every method, engine and backend, laws with memory, and any number of interruptions."""
    scenario = antenna(
        *CASES[case].get("overrides", ()), **{k: v for k, v in CASES[case].items() if k != "overrides"}
    )
    rng = np.random.default_rng([*case.encode()])
    whole = simulate(scenario, duration=0.02)
    assert len(whole.data["onset_time"]) > 1
    pieces = in_pieces(scenario, 0.02, tmp_path / "run.nc", rng, int(rng.integers(2, 7)))
    same(whole, pieces)
    same(Trajectory.load(tmp_path / "run.nc"), Trajectory.load(whole.save(tmp_path / "whole.nc")))
    assert sorted(os.listdir(tmp_path)) == ["run.nc", "whole.nc"]


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_what_events_have_done_is_kept(tmp_path, small_parts, engine):
    off = "action='set', set='drives.azimuth.on', to=false"
    event = f"events.far={{kind='angle', joint='azimuth', value=1e-3, {off}}}"
    scenario = antenna(event, "events.tick={kind='time', time=[0.003, 0.011]}", engine=engine)
    whole = simulate(scenario, duration=0.03)
    assert whole.data.sizes["event"] == 3
    same(whole, in_pieces(scenario, 0.03, tmp_path / "run.nc", np.random.default_rng(5), 8))


def test_a_changed_urdf_is_refused(tmp_path, small_parts):
    examples = Path(__file__).parents[2] / "scripts" / "examples" / "panel"
    for name in ("panel.urdf", "first.toml"):
        (tmp_path / name).write_text((examples / name).read_text(encoding="utf-8"), encoding="utf-8")
    how = {"duration": 0.01, "out": tmp_path / "run.nc"}
    assert not simulate(load_scenario(tmp_path / "first.toml"), progress=stop_after(2), **how).completed
    urdf = tmp_path / "panel.urdf"
    urdf.write_text(
        urdf.read_text(encoding="utf-8").replace('mass value="4"', 'mass value="5"'), encoding="utf-8"
    )
    with pytest.raises(
        FileFormatError, match="got one with another URDF: the file has changed; pass the inputs"
    ):
        simulate(load_scenario(tmp_path / "first.toml"), resume=True, **how)


@pytest.fixture(scope="module")
def stopped_once(tmp_path_factory):
    """The folder of a run that was asked to stop on its way."""
    folder = tmp_path_factory.mktemp("stopped")
    with pytest.MonkeyPatch.context() as patch:
        make_small(patch)
        ran = simulate(antenna(), duration=0.03, out=folder / "run.nc", progress=stop_after(90))
    assert ran.outcome is Outcome.INTERRUPTED
    return folder


@pytest.fixture
def stopped(stopped_once, tmp_path, small_parts):
    """A copy of the stopped run, by the name of its result."""
    shutil.copytree(stopped_once, tmp_path, dirs_exist_ok=True)
    return tmp_path / "run.nc"


def stop_after(reports):
    seen = []

    def look(progress):
        seen.append(progress)
        if len(seen) == reports:
            signal.raise_signal(signal.SIGINT)

    return look


def test_it_may_go_on_for_longer_than_it_was_to(stopped):
    later = simulate(antenna(), duration=0.04, out=stopped, resume=True)
    same(simulate(antenna(), duration=0.04), later)


def test_integers_of_a_program_keep_their_bits(stopped):
    """Some of its words are integers that as floats are NaN, and so differ from themselves."""
    found = Checkpoint.load(stopped)
    assert found.about["handed"] is not None
    assert found.about["before"] == []  # nothing was changed in this run
    assert not found.numbers["changed"].size


def test_what_is_no_checkpoint_of_the_run_is_refused(stopped, monkeypatch):
    """In one line each; what there is stays as it is."""
    folder = stopped.with_name("run.nc.parts")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}

    def refused(match, scenario=None, **more):
        with pytest.raises(AntennaPinError, match=match) as error:
            simulate(scenario or antenna(), **{"out": stopped, "resume": True, **more})
        assert "\n" not in str(error.value)

    refused("must be of this scenario, got one with another 'integrator'", antenna("integrator.rtol=1e-7"))
    refused("must be of this scenario", antenna("clearance.elevation.radial_clearance=0.3 mm"))
    refused("with these events", events=[Event(name="stop", when=Rate("elevation", 1.0), action=Stop())])
    refused("start must be left out with resume", start=Checkpoint.load(stopped).start)
    refused("duration must be beyond the checkpoint", duration=1e-5)
    refused("other.nc.parts': it was never stopped", out=stopped.with_name("other.nc"))
    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "library_versions", lambda: {"numpy": "0.1"})
        refused("must be of numpy 0.1, got one of")
    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "FORMAT", "antenna_pin checkpoint 7")
        refused("the format must be 'antenna_pin checkpoint 7', got 'antenna_pin checkpoint 5'")
    with checkpoint.SampleFiles(folder, np.zeros(0), "") as other:
        other.open()
        refused("another run writes into it")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert simulate(antenna(), out=stopped, resume=True).completed


@pytest.mark.parametrize("name", ["checkpoint", "000000.part"])
def test_a_damaged_checkpoint_or_part_is_refused(stopped, name):
    """A bit anywhere, an end cut off, a part that is gone or of another run."""
    path = stopped.with_name("run.nc.parts") / name
    whole, rng = path.read_bytes(), np.random.default_rng(9)
    spoiled = [whole[: int(rng.integers(0, len(whole)))] for _ in range(4)]
    for _ in range(12):
        place = int(rng.integers(0, len(whole)))
        spoiled.append(whole[:place] + bytes([whole[place] ^ 1 << int(rng.integers(8))]) + whole[place + 1 :])
    if name != "checkpoint":
        spoiled.append((path.parent / "000001.part").read_bytes())
    for content in spoiled:
        path.write_bytes(content)
        with pytest.raises(FileFormatError):
            simulate(antenna(), out=stopped, resume=True)
    path.unlink()
    with pytest.raises(FileFormatError):
        simulate(antenna(), out=stopped, resume=True)
    path.write_bytes(whole)
    assert simulate(antenna(), out=stopped, resume=True).completed


def test_a_full_disk_costs_nothing(tmp_path, small_parts, monkeypatch):
    """The run goes on in memory; parts that were written before are used, and so it is the whole run."""
    written = checkpoint.SampleFiles.append

    def full(self, chunk):
        if len(self.rows) >= 2:
            raise OutputError(f"{self.folder}: cannot be written: No space left on device")
        written(self, chunk)

    monkeypatch.setattr(checkpoint.SampleFiles, "append", full)
    with pytest.warns(NotKeptWarning, match="No space left on device; the run continues"):
        ran = simulate(antenna(), duration=0.03, out=tmp_path / "run.nc")
    same(simulate(antenna(), duration=0.03), ran)


def no_room(*given):
    raise OSError(28, "No space left")


def test_a_result_without_room_is_made_of_what_was_kept(tmp_path, small_parts, monkeypatch):
    """No step is made again: the record is there, with a checkpoint at its end."""
    with monkeypatch.context() as patch:
        patch.setattr(run_module, "write_blocks", no_room)
        with pytest.raises(OutputError, match=r"No space left; what the run has .* is in '.*run.nc.parts'"):
            simulate(antenna(), duration=0.03, out=tmp_path / "run.nc")
    again = simulate(antenna(), out=tmp_path / "run.nc", resume=True)
    same(simulate(antenna(), duration=0.03), again)


@pytest.mark.parametrize("asked", [1e-3, 0.5])
def test_checkpoints_take_a_tenth_of_the_time_at_most(tmp_path, monkeypatch, asked):
    """Whatever each costs, by a clock of the test's own: steps of 1 ms, checkpoints of up to 40 ms, 20 s.

    None comes before it is asked for, and the note is there if, and only if, one that was due had to wait.
    """
    now, rng, written = [0.0], np.random.default_rng(6), []

    def write(self, folder):
        began = now[0]
        now[0] += 0.04 * rng.random()
        written.append((began, now[0]))

    monkeypatch.setattr(checkpoint, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    monkeypatch.setattr(Checkpoint, "of", lambda run, about: Checkpoint)
    monkeypatch.setattr(Checkpoint, "write", classmethod(write))
    system = build_system(antenna())
    run = SimpleNamespace(samples=SimpleNamespace(size=0), outcome=Outcome.COMPLETED)
    with checkpoint.CheckpointStore(tmp_path / "run.nc", system, {}, asked) as kept:
        while now[0] < 20.0:
            now[0] += 1e-3
            run.wall = now[0]
            kept.observe(run)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            kept.end(run)
    waited = [(CheckpointsWaitedWarning, f"instead of the {asked:g} s asked")] if asked < 9 * 0.04 else []
    assert [one.category for one in said] == [category for category, _ in waited]
    assert all(words in str(one.message) for one, (_, words) in zip(said, waited, strict=True))
    costs = np.array([end - begin for begin, end in written])
    gaps = np.array([later[0] - one[1] for one, later in itertools.pairwise(written)])
    assert len(written) > 20 and (gaps >= asked).all()
    assert costs[:-1].sum() <= 0.1 * written[-1][0]
    # No longer than it must: the next step after it is due has it.
    assert (gaps <= np.maximum(asked, 9 * costs[:-1]) + 1.001e-3).all()


def test_a_system_built_in_python_goes_on(tmp_path, small_parts):
    system = build_system(antenna())
    q, v = initial_state(antenna(), system)
    used = RunSettings(max_step=2e-4, output_rate=2e4)
    whole = simulate(system, duration=0.02, q=q, v=v, settings=used)
    out = tmp_path / "run.nc"
    simulate(system, duration=0.02, q=q, v=v, settings=used, out=out, progress=stop_after(60))
    with pytest.raises(FileFormatError, match="must be of a run with these settings"):
        simulate(system, out=out, resume=True, settings=RunSettings(rtol=1e-3))
    same(whole, simulate(system, out=out, resume=True, settings=used))


def test_arrays_that_take_more_than_their_file_are_refused(tmp_path):
    """Ours are not packed; such a file is no larger in memory than on the disk."""
    path, known = tmp_path / "0001.npz", re.compile("times")
    with path.open("wb") as file:
        np.savez_compressed(file, times=np.zeros(10**6))
    seal(path)
    with pytest.raises(FileFormatError, match=r"0001\.npz: must be .*, got: packed arrays"):
        read_sealed(path, known)
    write_sealed(path, {"times": np.zeros(10**4)})
    assert len(read_sealed(path, known)["times"]) == 10**4
    with pytest.raises(FileFormatError, match=r"'times\.npy', which is not known"):
        read_sealed(path, re.compile("states"))


def header(shape):
    """Return an array's header that announces more numbers than follow it."""
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return stream.getvalue()


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    "members, said",
    [
        ([("times.npy", header((1,)) + bytes(8)), ("more.npy", b"")], "'more.npy', which is not known"),
        ([("times.npy", header((1,)) + bytes(8))] * 2, "times.npy 2 times"),
        (
            [("times.npy", header((10**12,)) + bytes(8))],
            r"times.npy of shape \(1000000000000,\) in 136 bytes",
        ),
        ([("times", header((1,)) + bytes(8))], "'times', which is not known"),
    ],
)
def test_members_that_are_not_ours_are_refused_unread(tmp_path, monkeypatch, members, said):
    """One not known, one there twice, one that announces more than it has."""
    path = tmp_path / "0001.npz"
    with zipfile.ZipFile(path, "w") as file:
        for name, content in members:
            file.writestr(name, content)
    seal(path)
    monkeypatch.setattr(np, "load", lambda *given, **more: pytest.fail("was read"))
    with pytest.raises(FileFormatError, match=said):
        read_sealed(path, re.compile("times"))


def with_about(numbers, **changes):
    about = json.loads(str(numbers["about"])) | changes
    return numbers | {"about": np.array(json.dumps(about))}


def counts_of(numbers):
    return json.loads(str(numbers["about"]))["counts"]


def of_contact(numbers, contact):
    episodes = numbers["book_episodes"].copy()
    episodes["contact"] = contact
    return episodes


FORGED = {
    "a billion programs": lambda old: old | {"programs": np.array(10**9)},
    "a change beyond": lambda old: old | {"changed": np.array([[0, 10**9]]), "values": np.array([1])},
    "an open episode beyond": lambda old: old | {"book_open": np.full_like(old["book_open"], 2**40)},
    "an episode of a contact beyond": lambda old: old | {"book_episodes": of_contact(old, 9)},
    "another shape": lambda old: old | {"states": old["states"][:, 1:]},
    "another kind": lambda old: old | {"times": old["times"].astype("f4")},
    "an array less": lambda old: {name: one for name, one in old.items() if name != "late_times"},
    "an array more": lambda old: old | {"tick_times_0": np.zeros(3)},
    "rows of a contact more": lambda old: old | {"book_open": np.append(old["book_open"], 0)},
    "no outcome": lambda old: with_about(old, outcome=None),
    "an unknown outcome": lambda old: with_about(old, outcome="X"),
    "no counts": lambda old: with_about(old, counts={}),
    "a scenario of another kind": lambda old: with_about(old, scenario="[]"),
    "a pace in words": lambda old: with_about(old, paced=[0, "x"]),
    "a pace beyond": lambda old: with_about(old, paced=[10**400, 0.0]),
    "steps beyond": lambda old: with_about(old, counts=counts_of(old) | {"accepted": 10**400}),
    "a word more": lambda old: with_about(old, more=1),
    "what happened in words": lambda old: with_about(old, happened=[["x"]]),
}


@pytest.mark.parametrize("change", FORGED)
def test_a_checkpoint_sealed_anew_is_refused_in_one_line(stopped, change):
    path = stopped.with_name("run.nc.parts") / "checkpoint"
    write_sealed(path, FORGED[change](read_sealed(path, re.compile(".*"))))
    with pytest.raises(
        FileFormatError, match=r"must be a checkpoint of a run|must be of this scenario"
    ) as error:
        simulate(antenna(), out=stopped, resume=True)
    assert "\n" not in str(error.value) and len(str(error.value)) < 500
