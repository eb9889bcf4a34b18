"""Names of the numbers of a state before a run; a closure that would share one with a joint."""

import pytest

from antenna_pin import System, build_system, load_scenario, simulate
from antenna_pin.base.records import MEMORY
from antenna_pin.errors import InvalidParameterError


@pytest.mark.parametrize(
    "case", [("bai2020", "case3"), ("slider_crank", "planar"), ("spherical_pendulum", None)]
)
def test_names_are_those_of_a_result(case):
    scenario = load_scenario(case[0], case=case[1])
    system = build_system(scenario)
    run = simulate(scenario, duration="0.1 ms")
    assert list(system.names_q) == list(run.data["configuration"].values)
    assert list(system.names_v) == list(run.data["coordinate"].values)
    assert (len(system.names_q), len(system.names_v)) == (system.model.nq, system.model.nv)
    assert run.end.memory.shape == (len(system.contact_names), len(MEMORY.names))


def test_no_closure_bears_the_name_of_a_joint():
    """Of a load, ``joint_loads`` had one name for both, and left the closure's out."""
    system = build_system(load_scenario("slider_crank", case="ideal"))
    (closure,) = system.closures.values()
    name = next(iter(system.mechanism.joints))
    with pytest.raises(InvalidParameterError, match="of another name than a joint's"):
        System(system.mechanism, closures={name: closure})
