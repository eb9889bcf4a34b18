"""The laws by name: what scenario files, the command line and the documentation read."""

import dataclasses
import re

import pytest
from value_classes import check_refusals

import antenna_pin.contact
from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    NORMAL_LAWS,
    DampedContact,
    ExactDamping,
    FloresDamping,
    Hertz,
    Johnson,
    Parameter,
    VelocityBased,
    is_elastic,
    law_parameters,
    make_normal_law,
    normal_parameters,
)

from .conftest import DIMENSIONS, EXAMPLES, instances, made

LAWS = {**NORMAL_LAWS, **FRICTION_LAWS}
EVERYTHING = {**{f"dissipation {name}": cls for name, cls in DISSIPATIONS.items()}, **LAWS}


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_law_refuses_numbers_that_break_their_rules(name):
    for law in made(instances({name: EVERYTHING[name]})):
        check_refusals(law)


def test_names_of_the_laws():
    # A law's name alone says which family it is of.
    assert not set(NORMAL_LAWS) & set(FRICTION_LAWS)
    assert all(re.fullmatch("[a-z0-9-]+", name) for name in EVERYTHING if " " not in name)


def test_every_dissipation_is_a_law_as_a_whole_too():
    """By the same name, with Hertz's power law; with the same force."""
    whole = {name for name in NORMAL_LAWS if not is_elastic(name)}
    assert whole == (set(DISSIPATIONS) - {"none"}) | {"bai-zhao"}
    for name in whole - {"bai-zhao"}:
        parameters = {key: EXAMPLES[key][0] for key in law_parameters(NORMAL_LAWS[name])}
        law = NORMAL_LAWS[name](**parameters)
        composed = make_normal_law("hertz", parameters, name)
        assert (law.code() == composed.code()).all(), name


def test_registries_are_read_only():
    for registry in (NORMAL_LAWS, FRICTION_LAWS, DISSIPATIONS):
        with pytest.raises(TypeError):
            registry["hertz"] = Hertz


def test_every_law_says_what_it_is_and_where_it_comes_from():
    for name, cls in EVERYTHING.items():
        parameters = law_parameters(cls)
        assert set(parameters) == {f.name for f in dataclasses.fields(cls)}, name
        for parameter in parameters.values():
            assert parameter.unit and parameter.doc, name
            # An effective mass has no default, but may be left out: each contact has one.
            assert parameter.required == (parameter.default is None and parameter.unit != "kg"), name
        doc = " ".join((cls.__doc__ or "").split())
        # A law as a whole points to its damping, which has the source.
        assert name in ("none", "dissipation none", "tanh") or "References:" in doc or ":class:" in doc, name


def test_elastic_and_dissipative_parameters_do_not_share_names():
    """They stand side by side in one table."""
    elastic = set().union(*(law_parameters(NORMAL_LAWS[name]) for name in NORMAL_LAWS if is_elastic(name)))
    dissipative = set().union(*(law_parameters(cls) for cls in DISSIPATIONS.values()))
    assert not elastic & dissipative


def test_unit_of_a_stiffness_follows_its_exponent():
    parameters = law_parameters(Hertz)
    assert parameters["stiffness"].unit == "N/m**exponent"
    own = Parameter("1", False, 1.5, parameters["exponent"].doc, rule="in [1, 4]")
    assert parameters["exponent"] == own
    assert law_parameters(VelocityBased)["static_speed"].unit == "m/s"


def test_what_follows_from_the_joint_is_marked():
    assert law_parameters(Hertz)["stiffness"].from_joint
    assert not law_parameters(Hertz)["exponent"].from_joint
    assert all(parameter.from_joint for parameter in law_parameters(Johnson).values())
    assert not normal_parameters("johnson", "flores")["restitution"].from_joint
    for name in ("tsuji", "jankowski"):
        mass = law_parameters(NORMAL_LAWS[name])["effective_mass"]
        assert mass.from_joint and not mass.required and mass.default is None
        made = make_normal_law("johnson", {**DIMENSIONS, "restitution": 0.8}, name)
        assert made.dissipation.effective_mass is None


def test_laws_are_made_from_names_and_numbers():
    assert make_normal_law("hertz", {"stiffness": 1e9}) == Hertz(stiffness=1e9)
    law = make_normal_law("johnson", {**DIMENSIONS, "restitution": 0.8}, "flores")
    assert law == DampedContact(elastic=Johnson(**DIMENSIONS), dissipation=FloresDamping(restitution=0.8))
    exact = make_normal_law("exact-restitution", {"stiffness": 1e9, "restitution": 0.8})
    assert exact.parts.dissipation == ExactDamping(restitution=0.8)
    assert list(normal_parameters("hertz", "tsuji")) == [
        "stiffness",
        "exponent",
        "restitution",
        "effective_mass",
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("herz", {}), "make_normal_law: law 'herz' is unknown; did you mean hertz? known:"),
        (
            ("hertz", {"stiffness": 1.0}, "floras"),
            "make_normal_law: dissipation 'floras' is unknown; did you mean flores? known:",
        ),
        (
            ("flores", {"stiffness": 1.0, "restitution": 0.5}, "flores"),
            "make_normal_law: dissipation must be left out, for law flores brings its own, got 'flores'",
        ),
        (
            ("hertz", {"stifness": 1.0}),
            "make_normal_law: parameters must be of stiffness, exponent (law hertz), got 'stifness'",
        ),
        (("hertz", {}), "make_normal_law: stiffness must be given (law hertz), got None"),
    ],
)
def test_bad_names_and_numbers_are_refused(arguments, message):
    with pytest.raises((ValueError, LookupError), match=f"^{re.escape(message)}"):
        make_normal_law(*arguments)


def test_every_registered_class_is_public():
    for cls in EVERYTHING.values():
        assert cls.__name__ in antenna_pin.contact.__all__, cls
