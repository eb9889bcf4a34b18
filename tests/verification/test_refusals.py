"""Wrong verification files: one line with place, rule, value and a way out."""

import pytest

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.sweep.journal import Journal
from antenna_pin.studies.verification import load_verification, verify

GOOD = "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\n"


@pytest.mark.parametrize(
    "text, said",
    [
        (
            "[requirements.far]\nquantity = 'final_positon'\nat_most = 1\n",
            "requirements.far.quantity: quantity 'final_positon' is unknown; did you mean final_position",
        ),
        (GOOD, "requirements.far must have a bound: at_most, at_least, or both; got none"),
        (GOOD + "at_most = '1 N'\n", "requirements.far.at_most must be a length"),
        (
            GOOD + "at_most = '1 m'\nat_least = '2 m'\n",
            "requirements.far.at_least must not be above at_most, '1 m', got '2 m'",
        ),
        (
            GOOD + "at_most = 1\nover = 'corners'\nvaries = ['pusch']\n",
            r"requirements.far.varies\[0\]: uncertain number 'pusch' is unknown; did you mean push",
        ),
        (
            GOOD + "at_most = 1\nover = 'study'\nprobability = 1.5\n",
            "requirements.far.probability must be between 0 and 1, got 1.5",
        ),
        (GOOD + "at_most = 1\nover = 'study'\n", "requirements.far.probability is missing"),
        (
            GOOD + "at_most = 1\nprobability = 0.9\n",
            'requirements.far.probability must be left out but for over = "study"',
        ),
        (GOOD + "at_most = 1\nover = 'always'\n", "requirements.far.over must be 'nominal'"),
        (
            GOOD + "at_most = 1\nband = ['2 Hz', '1 Hz']\n",
            "requirements.far.band must rise, got '2 Hz' to '1 Hz'",
        ),
        (
            GOOD + "at_most = 1\nband = ['1 Hz', '2 Hz']\n",
            "requirements.far.band must be left out: final_position has none; it takes of",
        ),
        (GOOD + "at_most = 1\natmost = 1\n", "requirements.far.atmost is unknown; did you mean at_most"),
        (
            "[requirements.off]\nquantity = 'deviation_rms'\nof = 'slide position'\nat_most = 1\n",
            "requirements.off: deviation_rms must have its reference, a table",
        ),
        (
            GOOD + "at_most = 1\n[uncertain.mass]\nkey = 'drives.push.mass'\nbetween = [1, 2]\n",
            "uncertain.mass.key: number of the scenario.*'drives.push.mass' is unknown",
        ),
        (
            GOOD + "at_most = 1\n[uncertain.load]\nkey = 'drives.push.value'\nbetween = ['1 m', '2 m']\n",
            "uncertain.load at 1.m: .*drives.push.value must be a torque .* or a force",
        ),
        (
            GOOD
            + "at_most = 1\n[uncertain.load]\nkey = 'drives.push.value'\nstart = 1\nstop = 2\ncount = 3\n",
            "uncertain.load.start must have values, between, distribution or tolerance",
        ),
        ("[requirements]\n", "requirements must hold one at least, got none"),
        (GOOD + "at_most = nan\n", "requirements.far.at_most must be a number, .* got nan"),
        (GOOD + "at_most = '1 parsnip'\n", "requirements.far.at_most must be .*'1 parsnip'"),
        (
            GOOD.replace("far", '"../far"') + "at_most = 1\n",
            "must have a name of letters, digits, _ and -, as the file .* got '../far'",
        ),
        (
            GOOD + "at_most = 1\nafter = '2 s'\n",
            "requirements.far.after must be left out: final_position has none",
        ),
    ],
)
def test_wrong_files_are_refused_in_one_line(sled, text, said):
    """Place and value of what is wrong, the rule, and near names."""
    with pytest.raises(AntennaPinError, match=said) as caught:
        load_verification(sled(text))
    assert "\n" not in str(caught.value)


def test_objects_and_times_that_are_not_there(sled):
    """Names of joints and signals are known once the mechanism is built."""
    plan = load_verification(
        sled("[requirements.far]\nquantity = 'final_position'\nof = 'slid'\nat_most = 1\n")
    )
    with pytest.raises(AntennaPinError, match="requirements.far: .*'slid' is unknown; did you mean slide"):
        verify(plan, sled("").parent / "out")
    text = GOOD.replace("final_position", "signal_peak").replace("'slide'", "'slide_position[slide]'")
    text += "at_most = 1\nafter = '9 s'\n"
    with pytest.raises(AntennaPinError, match="after must be a time with samples .* ends at 1 s, got 9 s"):
        verify(load_verification(sled(text)), sled("").parent / "out")


def test_two_verifications_in_one_folder_and_a_damaged_journal(sled):
    """One at a time; lines that are no points are left out and evaluated anew."""
    path = sled(GOOD + "at_most = '9 m'\nover = 'corners'\n")
    plan, folder = load_verification(path), path.parent / "out"
    first = verify(plan, folder)
    (journal,) = folder.glob("points/*/journal")
    whole = journal.read_bytes()
    for damaged in (whole[:-20], b"garbage{\n" + whole, b"\xff\x00" * 500, b""):
        journal.write_bytes(damaged)
        again = verify(plan, folder)
        assert again.met and again.points == first.points
    other = Journal(journal, b"of another process")
    with pytest.raises(AntennaPinError, match="must not be in use, got another process"):
        verify(plan, folder)
    other.close()
    file = path.parent / "file"
    file.touch()
    with pytest.raises(AntennaPinError, match="file: must be a folder, got a file"):
        verify(plan, file)


def test_a_scenario_has_requirements_of_its_own(sled):
    """They stand in its file, are checked when it is read, and go through copies unchanged."""
    folder = sled("").parent
    text = (folder / "sled.toml").read_text()
    own = "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_most = '5 m'\nover = 'corners'\n"
    more = "[uncertain.push]\nkey = 'drives.push.value'\nbetween = ['3 N', '5 N']\n"
    (folder / "own.toml").write_text(text + more + own)
    plan = load_verification(folder / "own.toml")
    assert plan.bounds == {"far": (-float("inf"), 5.0)} and plan.uncertain["push"].low == 3.0
    from antenna_pin.scenario import Scenario, load_scenario

    scenario = load_scenario(folder / "own.toml")
    again = Scenario.model_validate_json(scenario.model_dump_json())
    assert again.requirements == scenario.requirements and again.uncertain == scenario.uncertain
    assert scenario.with_overrides({"duration": 2.0}).requirements == scenario.requirements
    with pytest.raises(AntennaPinError, match="sled.toml: must have requirements, tables"):
        load_verification(folder / "sled.toml")
    (folder / "bad.toml").write_text(text + own)
    with pytest.raises(AntennaPinError, match="requirements.far.over must have numbers that vary, tables"):
        load_scenario(folder / "bad.toml")
