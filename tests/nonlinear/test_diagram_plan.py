"""Files of bifurcation diagrams: the shipped ones can be made, others are refused in one line."""

import pytest

from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.studies.nonlinear import list_plans, load_plan, values_of
from antenna_pin.studies.nonlinear.returns import SectionRun

PLAN = """
scenario = "pendulum"
parameter = "springs.hinge.stiffness"
values = "1 N*m/rad:2 N*m/rad:3"
quantities = ["motion_rate[hinge]"]
"""


@pytest.mark.parametrize("name", list_plans())
def test_a_shipped_diagram_can_be_made(name):
    """Its first and last value build a system with what is noted, looked at where it says."""
    plan = load_plan(name)
    values = plan.argument_values()
    for value in (values[0], values[-1]):
        SectionRun(plan.base().with_overrides({plan.parameter: value}), plan.where(), plan.quantities)
    assert plan.title and len(values) >= 10


def test_a_file_of_ones_own_says_what_the_command_would(tmp_path):
    file = tmp_path / "stiffness.diagram.toml"
    file.write_text(PLAN)
    plan = load_plan(file, {"count": 50})
    assert (plan.name, plan.count, plan.transient, plan.branches) == ("stiffness", 50, None, ("fresh",))
    assert plan.argument_values() == ["1.0 N*m/rad", "1.5 N*m/rad", "2.0 N*m/rad"]
    assert values_of("3, 1, 2 mm") == [3.0, 1.0, "2 mm"]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("paramter = 'duration'", "did you mean parameter"),
        ("count = 10", "count"),
        ("branches = ['sideways']", "branches"),
        ("name = 'mine'", "name is unknown"),
        ("format = true", "format must be 1, got true"),
    ],
)
def test_a_wrong_file_is_refused_by_its_key(tmp_path, line, says):
    file = tmp_path / "wrong.diagram.toml"
    file.write_text(f"{line}\n{PLAN}")
    with pytest.raises(ScenarioError, match=says) as refused:
        load_plan(file)
    assert "wrong.diagram.toml" in str(refused.value)


def test_what_is_no_diagram_is_named():
    with pytest.raises(UnknownNameError, match="did you mean chen2021/friction"):
        load_plan("chen2021/frictoin")
    with pytest.raises(InvalidParameterError, match="COUNT 2 or more"):
        values_of("1:2:1")
    with pytest.raises(InvalidParameterError, match="one unit"):
        values_of("1 mm:2 kg:3")
