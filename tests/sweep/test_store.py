"""The store: equal whatever was interrupted or damaged, and never that of another study."""

import json
import random
import shutil

import numpy as np
import pytest

from antenna_pin import open_study, run_study
from antenna_pin.errors import FileFormatError, OutputError
from antenna_pin.studies.sweep.journal import read_journal


@pytest.fixture
def whole(write, tmp_path, fake):
    """Return the bytes of the dataset of an uninterrupted study."""
    run_study(write(), tmp_path / "whole.study", executor=fake())
    return (tmp_path / "whole.study" / "runs.nc").read_bytes()


def test_order_and_interruptions_do_not_show(write, tmp_path, fake, whole):
    order, folder = random.Random(1), tmp_path / "cut.study"
    made = []
    for stop in (1, 0, 4, 3, None):
        executor = fake(order, stop)
        if stop is None:
            run_study(write(), folder, executor=executor)
        else:
            with pytest.raises(KeyboardInterrupt):
                run_study(write(), folder, executor=executor)
        made += executor.made
    assert sorted(made) == list(range(12))  # none twice
    assert (folder / "runs.nc").read_bytes() == whole


@pytest.mark.slow
def test_damage_is_found_and_made_again(write, tmp_path, fake, whole):
    """A bit flipped, or an end cut off, anywhere in the store: no wrong number, no other result lost."""
    folder = tmp_path / "whole.study"
    files = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    values = open_study(folder)["force"].values
    chance = random.Random(2)
    for name in ("journal", "runs.nc", "study.json") * 12:
        content = bytearray(files[name])
        place = chance.randrange(len(content))
        if chance.random() < 0.5:
            content[place] ^= 1 << chance.randrange(8)
        else:
            del content[place:]
        (folder / name).write_bytes(content)
        try:
            seen = open_study(folder)["force"].values
            assert (seen[~np.isnan(seen)] == values[~np.isnan(seen)]).all()
        except FileFormatError:
            assert name != "journal"
        executor, notes = fake(), []
        run_study(write(), folder, executor=executor, say=notes.append)
        assert (folder / "runs.nc").read_bytes() == whole
        # A torn end is part of one line; a flipped bit may join two.
        lost = 0 if name != "journal" else 12 - bytes(content[:place]).count(b"\n")
        assert len(executor.made) <= max(lost, 2 if name == "journal" else 0)
        assert len(notes) <= 1 and all("\n" not in note for note in notes)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"more": "results = 'failed'"}, "what differs: the results kept"),
        (
            {"parameters": '[parameters.e]\nkey = "duration"\nvalues = [0.001]'},
            "what differs: the parameters",
        ),
    ],
)
def test_a_store_of_another_study_is_not_written_to(write, tmp_path, fake, whole, change, said):
    folder = tmp_path / "whole.study"
    before = {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in folder.iterdir()}
    with pytest.raises(OutputError, match="store of another study") as refusal:
        run_study(write(**change), folder, executor=fake())
    assert said in str(refusal.value)
    table = run_study(write(**change), folder, executor=fake(), apart=True)
    assert table.attrs["path"].endswith("whole-2.study")
    after = {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in folder.iterdir()}
    assert after == before


def test_other_versions_are_refused(write, tmp_path, fake, whole, monkeypatch):
    import antenna_pin.studies.sweep.driver as prepare_module
    import antenna_pin.studies.sweep.jobs as work_module

    versions = {**work_module.library_versions(), "numpy": "9.9"}
    monkeypatch.setattr(prepare_module, "library_versions", lambda: versions)
    monkeypatch.setattr(work_module, "library_versions", lambda: versions)
    with pytest.raises(OutputError, match="of other versions: numpy .* is now 9.9"):
        run_study(write(), tmp_path / "whole.study", executor=fake())


def test_a_folder_of_something_else_is_left_alone(write, tmp_path, fake):
    folder = tmp_path / "mine.study"
    folder.mkdir()
    (folder / "thesis.txt").write_text("years")
    with pytest.raises(OutputError, match="contains nothing of this study"):
        run_study(write(), folder, executor=fake())
    assert [path.name for path in folder.iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize("what", ["folder", "journal", "replaced"])
def test_a_store_that_is_deleted_is_missed_at_the_next_run(write, tmp_path, fake, what):
    """Not at the end of a week, when all is written into a file without a name."""
    folder, seen = tmp_path / "gone.study", []

    def delete(standing):
        seen.append((standing.stage, standing.done))
        if seen[-1] == ("run", 3):
            shutil.rmtree(folder) if what == "folder" else (folder / "journal").unlink()
            if what == "replaced":
                (folder / "journal").write_bytes(b"")

    with pytest.raises(OutputError, match="journal: must stay while the study runs, got deleted or replaced"):
        run_study(write(), folder, executor=fake(), progress=delete)
    assert seen[-1] == ("run", 3)
    assert len(run_study(write(), folder, executor=fake()).force.values.ravel()) == 12


def test_a_store_that_is_deleted_while_the_missing_runs_are_checked_is_missed_before_any(
    write, tmp_path, fake
):
    """Its finished runs have been read by then: a journal begun anew would not have them."""
    folder, seen = tmp_path / "gone.study", []
    with pytest.raises(KeyboardInterrupt):
        run_study(write(), folder, executor=fake(stop=5))

    def delete(standing):
        seen.append(standing.stage)
        shutil.rmtree(folder, ignore_errors=True)

    with pytest.raises(OutputError, match="journal: must stay while the study runs, got deleted or replaced"):
        run_study(write(), folder, executor=fake(), progress=delete)
    assert set(seen) == {"check"} and not folder.exists()


def test_one_driver_at_a_time(write, tmp_path, fake):
    from antenna_pin.studies.sweep.journal import Journal

    folder = tmp_path / "busy.study"
    folder.mkdir()
    other = Journal(folder / "journal", b"k")
    with pytest.raises(OutputError, match=r"must not be in use|nothing of this study"):
        run_study(write(), folder, executor=fake())
    other.close()


def test_it_can_be_opened_while_it_runs(write, tmp_path, fake):
    with pytest.raises(KeyboardInterrupt):
        run_study(write(), tmp_path / "half.study", executor=fake(stop=7))
    path = tmp_path / "half.study" / "runs.nc"
    table = open_study(tmp_path / "half.study")
    assert (table["outcome"] == "PENDING").sum() == 5
    assert int(np.isfinite(table["force"]).sum()) == 7
    assert table["play"].attrs["units"] == "m" and table["play"].values.tolist() == [1e-4, 2e-4, 3e-4]
    assert path.stat().st_size > 0


def test_a_full_disk_costs_no_finished_run(write, tmp_path, fake, whole, monkeypatch):
    """The line that does not fit is taken back; the study goes on when there is room."""
    import os

    from antenna_pin.studies.sweep import journal

    real, room = os.write, [1500]

    def write_some(descriptor, content):
        # Others write too, such as the one that this process of tests reports to.
        if not os.readlink(f"/proc/self/fd/{descriptor}").endswith("journal"):
            return real(descriptor, content)
        if room[0] <= 0:
            raise OSError(28, "No space left on device")
        done = real(descriptor, bytes(content[: room[0]]))
        room[0] -= done
        return done

    monkeypatch.setattr(journal.os, "write", write_some)
    folder = tmp_path / "full.study"
    with pytest.raises(OutputError, match="No space left on device"):
        run_study(write(), folder, executor=fake())
    kept = read_journal(folder / "journal", bytes.fromhex(json.loads(_about(folder))["digest"])[:32])
    assert len(kept.entries) >= 3 and not kept.torn and not kept.damaged
    room[0] = 10**9
    executor = fake()
    run_study(write(), folder, executor=executor)
    assert len(executor.made) == 12 - len(kept.entries)
    assert (folder / "runs.nc").read_bytes() == whole


def _about(folder):
    return (folder / "study.json").read_text().rpartition("\nantenna_pin")[0]
