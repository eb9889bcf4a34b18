"""The couplings of a scenario, beside those of its URDF."""

from __future__ import annotations

from antenna_pin.assemble.places import check_known, check_motion, where
from antenna_pin.constraints import Coupling
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import CouplingSpec, DifferentialSpec, PlanetarySpec, Scenario

__all__ = ["couplings_of"]


def couplings_of(scenario: Scenario, mechanism: Mechanism) -> dict[str, Coupling]:
    """Return the couplings of a scenario by name; not those whose follower it locks.

    Raises:
        ScenarioError: Joints that there are not, units of other joints, a name that is taken.
    """
    joints = [joint.name for joint in mechanism.urdf.robot.joints]
    found = {}
    for name, spec in scenario.couplings.items():
        place = ("couplings", name)
        for key in spec.roles.values():
            if (joint := getattr(spec, key)) is not None:
                check_known(scenario, [joint], "joint", joints, *place, key)
        change = scenario.mechanism.joints.get(getattr(spec, spec.roles["follower"]))
        if change is not None and change.kind == "locked":
            continue
        for what, taken in (("closure", scenario.closures), ("joint with <mimic>", mechanism.urdf.mimics)):
            if name in taken:
                raise ScenarioError(
                    f"{where(scenario, *place)}: must have another name; there is a {what} {name!r}"
                )
        if isinstance(spec, CouplingSpec):
            _check_units(scenario, mechanism, spec, *place)
        try:
            found[name] = _built(spec)
        except InvalidParameterError as error:
            key = spec.roles.get(error.parameter, error.parameter)
            raise ScenarioError(f"{where(scenario, *place, key)}: {error.reason}") from None
    return found


def _built(spec: CouplingSpec | DifferentialSpec | PlanetarySpec) -> Coupling:
    if isinstance(spec, DifferentialSpec):
        return Coupling.differential(carrier=spec.carrier, first=spec.first, second=spec.second)
    if isinstance(spec, PlanetarySpec):
        return Coupling.planetary(carrier=spec.carrier, sun=spec.sun, ring=spec.ring, ratio=spec.ratio)
    return Coupling(
        follower=spec.follower,
        leader=spec.leader,
        multiplier=spec.multiplier,
        offset=spec.offset,
        second=spec.second,
        second_multiplier=spec.second_multiplier,
    )


def _check_units(scenario: Scenario, mechanism: Mechanism, spec: CouplingSpec, *place: str) -> None:
    """Refuse units that are not those of the joints."""
    if spec.follower not in mechanism.joints:
        return
    follower = mechanism.joint(spec.follower)
    check_motion(scenario, follower, spec.motion, *place, "offset")
    if spec.leader not in mechanism.joints:
        return
    units = ["m" if slot.kind == "prismatic" else "rad" for slot in (follower, mechanism.joint(spec.leader))]
    ratio = "1" if units[0] == units[1] else "/".join(units)
    if spec.conversion not in (None, ratio):
        raise ScenarioError(
            f"{where(scenario, *place, 'multiplier')}: must be a number"
            f"{'' if ratio == '1' else f' in {ratio}'}, for {spec.follower!r} is {follower.kind} and "
            f"{spec.leader!r} {mechanism.joint(spec.leader).kind}, got units of {spec.conversion}"
        )
