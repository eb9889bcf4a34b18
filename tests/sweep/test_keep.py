"""Studies record what their measures need: by themselves, or as they are told."""

import numpy as np
import pytest

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.sweep import prepare, run_study
from antenna_pin.studies.sweep.jobs import scenario_of

STUDY = """
scenario = "impact_pair"
{more}
[set]
duration = "2 ms"

{parameters}

[responses]
force = {{ measure = "peak_force" }}
blows = {{ measure = "blows" }}
lost = {{ measure = "total_normal_loss" }}
"""

PLAY = """
[parameters.play]
key = "clearance.bore.radial_clearance"
values = ["0.1 mm", "0.15 mm", "0.2 mm", "0.3 mm"]
"""
NAMES = ("peak_force", "blows", "total_normal_loss")


def base_of(study):
    plan = prepare(study)
    return scenario_of(plan.work, plan.job(0)).output


def test_measures_and_outcomes_are_those_of_a_full_record(write, tmp_path):
    """The default leaves out what is not asked for; nothing that is asked for shows it."""
    few, every = write(PLAY, text=STUDY), write(PLAY, 'keep = "all"', text=STUDY)
    assert base_of(few).keep == NAMES and base_of(few).form == "lean"
    assert base_of(every).keep is None and base_of(every).form == "full"
    tables = [run_study(study, tmp_path / f"{k}.study") for k, study in enumerate((few, every))]
    for name in ("force", "blows", "lost", "outcome", "steps", "evaluations", "end_time"):
        assert np.array_equal(*(table[name].values for table in tables)), name
    assert tables[0]["force"].values.max() > 0.0


def test_a_study_that_keeps_little_is_resumed(write, tmp_path):
    """Part of its journal is lost: the same command makes these runs again, byte for byte the same."""
    study = write(PLAY, 'keep = ["peak_force", "blows", "total_normal_loss", "final_angle"]', text=STUDY)
    run_study(study, tmp_path / "one.study")
    made = (tmp_path / "one.study" / "runs.nc").read_bytes()
    journal = tmp_path / "one.study" / "journal"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-2]))
    run_study(study, tmp_path / "one.study")
    assert (tmp_path / "one.study" / "runs.nc").read_bytes() == made


@pytest.mark.parametrize(
    ("old", "new", "more"),
    [
        ("[responses]", '[responses]\nown = "own.py:number"', ""),  # it may read anything
        ("[responses]", '[responses]\nturn = "base_turn"', ""),
        ("[responses]", '[responses]\nerror = "energy_error"', ""),  # of all samples
        ("[set]", '[set]\noutput.form = "full"', ""),
        ("[set]", "[set]", 'results = "failed"'),  # whose files are for readers
    ],
)
def test_all_is_recorded_where_it_may_be_needed(write, tmp_path, old, new, more):
    (tmp_path / "own.py").write_text("def number(run):\n    return 1.0\n")
    assert base_of(write(PLAY, more, text=STUDY.replace(old, new))).keep is None


@pytest.mark.parametrize(
    ("old", "new", "keep", "said"),
    [
        ("", "", '["peak_force", "blows"]', "responses.lost its measure total_normal_loss must be in keep"),
        ("", "", '["peak_forces"]', r"keep\[0\]: quantity 'peak_forces' is unknown; did you mean peak_force"),
        ("lost = ", 'turn = "base_turn"\nlost = ', str(list(NAMES)), "base_turn needs the series of a run"),
        ("[set]", '[set]\noutput.form = "full"', str(list(NAMES)), "keep must be left out with set.output"),
    ],
)
def test_a_record_without_what_a_response_needs_is_refused(write, old, new, keep, said):
    with pytest.raises(AntennaPinError, match=said):
        write(PLAY, f"keep = {keep}", text=STUDY.replace(old, new) if old else STUDY)
