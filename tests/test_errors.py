"""Names that a message suggests."""

import string

import pytest
from hypothesis import given
from hypothesis import strategies as st

from antenna_pin.errors import UnknownNameError, nearest

PD = ("joint", "kind", "axis", "kp", "kd", "limit", "time", "reference", "reference_rate", "file")
JOINT = ("model", "bearing_radius", "radial_clearance", "axial_clearance", "journal_material", "tilt")
METHODS = ("rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853", "radau5")
SPRING = ("joint", "stiffness", "damping", "rest_angle", "shorter_way", "on")


@pytest.mark.parametrize(
    ("name", "known", "meant"),
    [
        ("ki", PD, None),  # neither kind, which it begins, nor kp, of which it shares one letter of two
        ("k", PD, None),
        ("KP", PD, "kp"),
        ("kpp", PD, "kp"),
        ("dk", PD, "kd"),
        ("kin", PD, "kind"),
        ("kidn", PD, "kind"),
        ("ikne", PD, "kind"),  # two swapped and one mistaken: a letter and a half of four
        ("kixy", PD, None),  # two mistaken
        ("limits", PD, "limit"),
        ("lim", PD, "limit"),
        ("refrence", PD, "reference"),
        ("rate", PD, "reference_rate"),
        ("gain", PD, None),
        ("stiffness", PD, None),
        ("clearence", JOINT, "radial_clearance"),
        ("radial clearance", JOINT, "radial_clearance"),
        ("radial-clearence", JOINT, "radial_clearance"),
        ("material", JOINT, "journal_material"),
        ("radius", JOINT, "bearing_radius"),
        ("modle", JOINT, "model"),
        ("play", JOINT, None),
        ("rk5", METHODS, "rk4"),
        ("radau", METHODS, "radau5"),
        ("dormand-prince", METHODS, "dormand-prince-54"),
        ("dormand-prince-45", METHODS, "dormand-prince-54"),
        ("Dormand-Prince-853", METHODS, "dormand-prince-853"),
        ("euler", METHODS, None),
        ("of", SPRING, None),
        ("no", SPRING, "on"),
        ("onn", SPRING, "on"),
        ("dampin", SPRING, "damping"),
        ("angle", SPRING, "rest_angle"),
        ("spline", ("linear", "cubic"), None),
        ("value", ("amplitude", "frequency", "phase"), None),
        ("a" * 100_000, ("a" * 99_999,), None),  # nobody writes such a name by a slip
        ("", PD, None),
    ],
)
def test_a_name_is_taken_for_what_it_is_a_slip_of(name, known, meant):
    assert nearest(name, known) == meant


@given(
    name=st.text(string.ascii_lowercase, min_size=4, max_size=20),
    others=st.lists(st.text(string.digits, min_size=1, max_size=20), max_size=5),
    slip=st.sampled_from(["swapped", "left out", "doubled", "mistaken", "upper case"]),
    at=st.integers(0, 18),
)
def test_one_slip_in_four_letters_is_seen_through(name, others, slip, at):
    at = min(at, len(name) - 2)
    typed = {
        "swapped": name[:at] + name[at + 1] + name[at] + name[at + 2 :],
        "left out": name[:at] + name[at + 1 :],
        "doubled": name[: at + 1] + name[at] + name[at + 1 :],
        "mistaken": name[:at] + "_" + name[at + 1 :],
        "upper case": name.upper(),
    }[slip]
    assert nearest(typed, [*others, name]) == name


@pytest.mark.parametrize("name", ["rol", "spring", "comand", "alpha"])
@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_double_letter_is_likelier_than_one_lost_or_added(name, at):
    """A name in which a letter is double is typed with it once, or the other way round."""
    double = name[: at + 1] + name[at:]
    added = name[: at + 1] + "z" + name[at + 1 :]
    lost = double[1:] if at else double[:-1]
    for known in ((double, added), (added, double)):
        assert nearest(name, known) == double
    for known in ((name, lost), (lost, name)):
        assert nearest(double, known) == name


def test_a_message_without_a_guess_says_what_is_known():
    assert str(UnknownNameError("my", "key", "ki", PD[3:5])) == "my: key 'ki' is unknown; known: kd, kp"
    assert str(UnknownNameError("my", "key", 3, PD[3:5])) == "my: key 3 is unknown; known: kd, kp"
