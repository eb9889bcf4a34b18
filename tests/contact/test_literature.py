"""Numbers that were published or computed elsewhere: forces of a joint, restitutions."""

import math

import pytest

from antenna_pin.analysis.law_studies import elastic_laws_of_joint, force_table
from antenna_pin.contact import DISSIPATIONS, MATERIALS, ExactDamping, delivered_restitution


def test_bais_joint_against_the_published_size_of_each_law():
    """Forces at 0.1, 1, 5 and 20 um for 10/9.8 mm, 50 mm, E = 207 GPa, nu = 0.3."""
    steel = MATERIALS["steel"]
    laws = elastic_laws_of_joint(
        bearing_radius=0.01, journal_radius=0.0098, length=0.05, bearing=steel, journal=steel
    )
    table = force_table(laws, (1e-7, 1e-6, 5e-6, 2e-5))
    published = {
        "hertz": ("3.36", "106", "1187", "9495"),
        "liu-foundation": ("14.1", "446", "4932", "38090"),
        "bai-zhao-elastic": ("21.2", "667", "7338", "55403"),
    }
    for name, row in published.items():
        for value, text in zip(table[name], row, strict=True):
            digits = len(text.replace(".", "").lstrip("0"))
            size = 10.0 ** (math.floor(math.log10(float(text))) + 1 - min(digits, 4))
            assert value == pytest.approx(float(text), abs=0.51 * size)  # to the rounding of the table


@pytest.mark.parametrize(
    ("asked", "lankarani", "zhiying", "hunt", "flores", "exact"),
    [(0.90, 0.9132, 0.8959, 0.9090, 0.8939, 0.16648), (0.95, 0.9535, 0.9489, 0.9524, 0.9468, 0.07893)],
)
def test_restitution_that_laws_deliver(asked, lankarani, zhiying, hunt, flores, exact):
    """Four digits of a table computed elsewhere, and the factor that delivers what is asked for."""
    for name, expected in (
        ("lankarani-nikravesh", lankarani),
        ("zhiying-qishao", zhiying),
        ("hunt-crossley", hunt),
        ("flores", flores),
    ):
        factor = DISSIPATIONS[name](restitution=asked).hysteresis
        assert delivered_restitution(factor) == pytest.approx(expected, abs=5.1e-5)
    assert ExactDamping(restitution=asked).hysteresis == pytest.approx(exact, abs=5.1e-6)
