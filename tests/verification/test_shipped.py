"""Shipped requirements: they load, and their nominal runs meet them."""

import pytest

from antenna_pin.studies.verification import list_verifications, load_verification
from antenna_pin.studies.verification.evaluation import (
    EvaluatedPoint,
    EvaluationWork,
    evaluate_points,
    key_of,
)


@pytest.mark.parametrize("name", list_verifications())
def test_shipped_files_have_texts_units_and_limits(name):
    """Each requirement says what it asks for, and each uncertain number lies within its limits."""
    plan = load_verification(name)
    assert all(spec.text for spec in plan.requirements.values())
    for one in plan.uncertain.values():
        assert one.low < one.nominal < one.high


@pytest.mark.slow
@pytest.mark.parametrize("name", list_verifications())
def test_nominal_run_of_shipped_files_meets_them(name):
    """All bounds hold, with every quantity computed, and the run balances."""
    plan = load_verification(name)
    specs = {key_of(spec): spec for spec in plan.requirements.values()}
    reference = "" if plan.reference is None else plan.reference.model_dump_json()
    work = EvaluationWork(plan.base.model_dump_json(), reference, specs, plan.sources)
    (entry,) = evaluate_points(work, [EvaluatedPoint("{}", {}, tuple(specs))])
    for requirement, (low, high) in plan.bounds.items():
        value = entry["values"][key_of(plan.requirements[requirement])]
        assert low <= value <= high, (requirement, value, entry["errors"])
    assert entry["facts"]["energy_error"] < entry["facts"]["energy_tolerance"]
