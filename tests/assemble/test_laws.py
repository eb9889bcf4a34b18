"""What a law takes from the joint that it stands in, and what gives way where a line means nothing."""

import math

import pytest

from antenna_pin import AntennaPinError, load_scenario
from antenna_pin.contact import (
    DISSIPATIONS,
    MATERIALS,
    BaiZhao,
    DampedContact,
    FloresDamping,
    Hertz,
    Johnson,
    LiuFoundation,
    ZhiyingQishaoDamping,
    annular_punch_factor,
    effective_modulus,
    hertz_stiffness,
)
from antenna_pin.scenario.assemble import build_system

STEEL = MATERIALS["steel"]
MODULUS = effective_modulus(STEEL, STEEL)
NORMAL = "clearance.elevation.normal={replace=true, %s}"
JOHNSON = NORMAL % "law='johnson', dissipation='flores', restitution=0.8"


def joint(*overrides, case="case3"):
    return build_system(load_scenario("bai2020", case=case, overrides=overrides)).clearances[0]


def line(length):
    return {"length": length, "journal_radius": 0.0098, "bearing_radius": 0.01, "modulus": MODULUS}


def same(law, expected):
    assert type(law.parts.elastic) is type(expected.parts.elastic)
    assert law.parts.dissipation == expected.parts.dissipation
    assert law.code() == pytest.approx(expected.code(), rel=1e-12, abs=0.0)  # 10 mm less 0.2 mm


def test_a_line_law_takes_its_line_from_the_joint():
    """Half of it at each end, the whole in a plane; what is given goes before."""
    flores = FloresDamping(restitution=0.8)
    same(joint(JOHNSON).radial, DampedContact(elastic=Johnson(**line(0.025)), dissipation=flores))
    made = joint(JOHNSON, case="case2-planar")
    same(
        made.radial, DampedContact(elastic=Johnson(**line(0.05)), dissipation=FloresDamping(restitution=0.8))
    )
    assert made.axial is None
    # However many strips share it out.
    for strips in (16, 24):
        load = ("clearance.elevation.load=distributed", f"clearance.elevation.strips={strips}")
        same(joint(NORMAL % "law='liu-foundation'", *load).radial, LiuFoundation(**line(0.025)))
    law = joint(NORMAL % "law='johnson', length='10 mm', modulus='90 GPa', bearing_radius='11 mm'").radial
    assert (law.length, law.modulus, law.bearing_radius) == (0.01, 90e9, 0.011)
    assert law.journal_radius == pytest.approx(0.0098, rel=1e-12)


@pytest.mark.parametrize("dissipation", ["none", "flores", "exact-restitution"])
def test_at_the_flanges_a_line_law_gives_way_to_hertz(dissipation):
    """With the stiffness of a point contact in the bore, and the same dissipation."""
    more = "" if dissipation == "none" else ", restitution=0.8"
    made = joint(NORMAL % f"law='johnson', dissipation='{dissipation}'{more}")
    expected = DampedContact(
        elastic=Hertz(stiffness=hertz_stiffness(0.01, 0.0098, STEEL, STEEL)),
        dissipation=DISSIPATIONS[dissipation](**({} if dissipation == "none" else {"restitution": 0.8})),
    )
    same(made.axial, expected)
    # Without one named it is conservative too.
    assert joint(NORMAL % "law='johnson'").axial.force(1e-6, 0.1, 0.1) == made.axial.elastic_force(1e-6)


def test_a_whole_line_law_hands_its_dissipation_to_the_flanges():
    made = joint(NORMAL % "law='bai-zhao', restitution=0.9")
    assert isinstance(made.radial, BaiZhao)
    assert isinstance(made.axial.parts.elastic, Hertz)
    assert made.axial.parts.dissipation == ZhiyingQishaoDamping(restitution=0.9)


def test_the_flanges_may_have_a_law_and_a_dissipation_of_their_own():
    made = joint(JOHNSON, "clearance.elevation.axial={law='hertz', stiffness='3e10 N/m**1.5'}")
    same(made.axial, Hertz(stiffness=3e10))
    made = joint(JOHNSON, "clearance.elevation.axial={law='hertz'}")
    assert made.axial.stiffness == pytest.approx(hertz_stiffness(0.01, 0.0098, STEEL, STEEL), rel=1e-12)
    made = joint(JOHNSON, "clearance.elevation.axial.restitution=0.4")
    assert made.axial.parts.dissipation == FloresDamping(restitution=0.4)
    assert made.radial.parts.dissipation == FloresDamping(restitution=0.8)


def test_flanges_under_distributed_load_beside_a_line_law_are_a_foundation():
    """Of the modulus given, over the whole annulus; or of a rigid annular punch, 10 mm in 12 mm."""
    line_law, load = NORMAL % "law='liu-foundation'", "clearance.elevation.load=distributed"
    given = joint(line_law, load, "clearance.elevation.flange_modulus='2e13 N/m**3'").axial.parts.elastic
    area = math.pi * (0.012**2 - 0.01**2)
    assert given.exponent == 1.0
    assert given.stiffness == pytest.approx(2e13 * area, rel=1e-12)
    punch = joint(line_law, load, "clearance.elevation.sectors=24").axial.parts.elastic
    assert punch.stiffness == pytest.approx(0.8776439 * 2.0 * MODULUS * 0.012, rel=1e-7)
    narrow = joint(line_law, load, "clearance.elevation.flange_radius='10.5 mm'").axial.parts.elastic
    factor = annular_punch_factor(10.0 / 10.5)
    assert 0.7 < factor < 0.75
    assert narrow.stiffness == pytest.approx(factor * 2.0 * MODULUS * 0.0105, rel=1e-12)


def test_limits_of_depth_name_what_rules():
    """The range of the law in the bore, the joint's own limit at the flanges."""
    made = joint(JOHNSON, "clearance.elevation.maximum_depth='0.5 mm'")
    turn_over = Johnson(**line(0.025)).depth_limit
    assert made.depth_limits == pytest.approx((turn_over, turn_over, 5e-4, 5e-4), rel=1e-12)
    assert made.limit_reasons == (
        "the range of Johnson ends there",
        "the range of Johnson ends there",
        "maximum_depth",
        "maximum_depth",
    )
    assert set(joint().limit_reasons) == {"maximum_depth"}


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            [JOHNSON, "clearance.elevation.axial={law='persson', dissipation='none'}"],
            "bai2020: clearance.elevation.axial.law: must be a law of a point, such as hertz, for a flange"
            " has no line of contact, got 'persson'",
        ),
        (
            [NORMAL % "law='pereira'", "clearance.elevation.radial_clearance='1 um'"],
            "bai2020: clearance.elevation.normal: Pereira: bearing_radius must be such that the play is 5 um "
            "to 10 mm, for which the law was fitted, got 0.01",
        ),
        (
            [NORMAL % "law='kelvin-voigt', damping=100"],
            "bai2020: clearance.elevation.normal.stiffness: must be given for the exponent 1; only for 1.5 "
            "does it follow from materials",
        ),
    ],
)
def test_refusals_say_where_and_why(overrides, message):
    with pytest.raises(AntennaPinError) as caught:
        joint(*overrides)
    assert str(caught.value) == message
