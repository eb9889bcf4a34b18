"""What does not fit is refused before it is made: by its estimate, in one line, with what to make less."""

import pytest

from antenna_pin import System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.base import capacity
from antenna_pin.errors import AntennaPinError, TooLargeError
from antenna_pin.studies.nonlinear import bifurcation, largest_exponent, poincare
from antenna_pin.studies.nonlinear.diagram_plan import values_of
from antenna_pin.studies.nonlinear.sections import section_of

BODY = (
    '<inertial><origin xyz="0 0 -0.05"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def chain(count):
    """A chain of hinges."""
    links = [f'<link name="l{k}">{BODY}</link>' for k in range(count + 1)]
    joints = [
        f'<joint name="j{k}" type="continuous"><parent link="l{k}"/><child link="l{k + 1}"/>'
        '<origin xyz="0 0 -0.1"/><axis xyz="0 1 0"/></joint>'
        for k in range(count)
    ]
    return Urdf.from_text(f'<robot name="chain">{"".join(links + joints)}</robot>', "chain.urdf")


def test_a_chain_too_long_for_the_machine_is_refused_with_its_estimate(monkeypatch):
    monkeypatch.setattr(capacity, "free_memory", lambda: 20e9)
    said = (
        "chain.urdf: 1006 degrees of freedom would need 97.7 GB of memory, and this machine has 20 GB free; "
        "leave joints out or lock some"
    )
    with pytest.raises(TooLargeError, match=said) as error:
        build_mechanism(chain(1000))
    assert isinstance(error.value, MemoryError)
    assert build_mechanism(chain(30)).model.nv == 36


def test_samples_that_do_not_fit_are_refused_before_the_first_step(monkeypatch):
    monkeypatch.setattr(capacity, "free_memory", lambda: 1e9)
    scenario = load_scenario("pendulum", overrides={"output.rate": 1e6})
    with pytest.raises(
        TooLargeError, match=r"simulate: 9e\+06 samples of a state of \d+ numbers would need .* GB"
    ):
        simulate(scenario, duration=9.0)


def test_memory_that_is_not_told_refuses_nothing(monkeypatch):
    """What is free is some of it."""
    assert 1e6 < capacity.free_memory() < 1e15
    monkeypatch.setattr(capacity, "free_memory", lambda: None)
    capacity.check_fits("here", "all", 1e30, "less")


@pytest.mark.parametrize(
    "ask",
    [
        lambda much: poincare(load_scenario("pendulum"), section_of("period=1 s"), ["time"], count=much),
        lambda much: largest_exponent.__wrapped__(None, None, 1.0, much),
        lambda much: bifurcation(
            load_scenario("pendulum"),
            "springs.x.stiffness",
            [1.0],
            section_of("period=1 s"),
            ["a"],
            count=much,
        ),
        lambda much: values_of(f"0:1:{much}"),
        lambda much: simulate(
            load_scenario("pendulum", overrides={"output.rate": float(much)}), duration=1.0
        ),
    ],
)
def test_what_is_counted_is_at_most_ten_million(ask):
    with pytest.raises(AntennaPinError, match=r"at most 10000000|1e\+07 samples"):
        ask(1_000_000_000)


@pytest.mark.slow
def test_a_chain_of_300_hinges_runs():
    system = System(build_mechanism(chain(300)))
    assert simulate(system, duration=1e-3).completed
