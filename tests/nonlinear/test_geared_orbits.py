"""Periodic solutions of joints that are geared to others, against closed forms."""

import numpy as np
import pytest

from antenna_pin import Coupling, System, Urdf, build_mechanism
from antenna_pin.elements import Gear, JointSpring, SineDrive
from antenna_pin.mechanism import Rotor, with_rotor
from antenna_pin.studies.nonlinear import Flow, periodic_orbit

LINK = (
    '<link name="{0}"><inertial><mass value="1"/>'
    '<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="base"/><child link="{0}_link"/><axis xyz="0 0 1"/>'
    '<limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>'
)
INERTIA, FREQUENCY = 0.05, 1.3


def _urdf(names: str) -> Urdf:
    text = LINK.format("base") + "".join(JOINT.format(name) + LINK.format(f"{name}_link") for name in names)
    return Urdf.from_text(f'<robot name="discs">{text}</robot>', "discs.urdf")


def _parts(names: str) -> dict[str, dict[str, object]]:
    springs = {name: JointSpring(joint=name, stiffness=4.0, damping=0.3) for name in names}
    return {"springs": springs, "drives": {"d": SineDrive(joint="a", amplitude=0.5, frequency=FREQUENCY)}}


def _sorted(values: np.ndarray) -> np.ndarray:
    """Return numbers in an order that round-off of conjugate ones does not change."""
    return values[np.lexsort((values.imag, np.round(values.real, 7)))]


def _multipliers(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Return exp(lambda T) of a linear system."""
    n = len(mass)
    lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    values = np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower]))
    return _sorted(np.exp(values / FREQUENCY))


def _found(system: System) -> np.ndarray:
    flow = Flow(system)
    rest = flow.first(system.neutral(), np.zeros(system.model.nv))
    return _sorted(periodic_orbit(flow, rest, 1.0 / FREQUENCY).multipliers)


def test_a_gear() -> None:
    """In mesh it is a spring between two oscillators."""
    gear = Gear(input="a", output="b", ratio=-2.0, stiffness=3.0, damping=0.1)
    system = System(build_mechanism(_urdf("ab"), "fixed"), elements={"gears": {"g": gear}}, **_parts("ab"))
    along = np.outer([-0.5, -1.0], [-0.5, -1.0])
    expected = _multipliers(INERTIA * np.eye(2), 0.3 * np.eye(2) + 0.1 * along, 4.0 * np.eye(2) + 3.0 * along)
    assert _found(system) == pytest.approx(expected, abs=1e-9)  # differences of runs


def test_a_differential() -> None:
    """Two freedoms of three joints: those of the sides, which the carrier follows."""
    couplings = {"c": Coupling.differential(carrier="c", first="a", second="b")}
    system = System(build_mechanism(_urdf("abc"), "fixed"), couplings=couplings, **_parts("ab"))
    sides, one = np.eye(2) + np.full((2, 2), 0.25), np.eye(2)
    assert _found(system) == pytest.approx(_multipliers(INERTIA * sides, 0.3 * one, 4.0 * one), abs=1e-9)


@pytest.mark.parametrize("kind", ["exact", "armature"])
def test_a_rotor(kind: str) -> None:
    """It is so much more inertia, as a body and as armature."""
    ratio, inertia, urdf = 10.0, 4e-4, _urdf("a")
    if kind == "exact":
        mechanism = build_mechanism(
            with_rotor(urdf, "m", Rotor(joint="a", inertia=inertia, ratio=ratio)), "fixed"
        )
    else:
        mechanism = build_mechanism(urdf, "fixed", armature={"a": ratio**2 * inertia})
    one = np.eye(1)
    expected = _multipliers((INERTIA + ratio**2 * inertia) * one, 0.3 * one, 4.0 * one)
    assert _found(System(mechanism, **_parts("a"))) == pytest.approx(expected, abs=1e-9)
