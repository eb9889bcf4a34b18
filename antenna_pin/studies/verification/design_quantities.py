"""Quantities of a design: modes, loops, margins, statics, contact stress, tolerances."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.quantity import Case, Find, Value, VerifiedQuantity, chosen

# --- small motions ---


def _modes(case: Case) -> Any:
    from antenna_pin.studies.linear import modes

    found = case.memo.get("modes")
    if found is None:
        found = case.memo["modes"] = modes(case.scenario)
    return found


def _mode(column: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> float:
        found = _modes(case)
        elastic = [k for k, kind in enumerate(found.data["kind"].values) if kind == "elastic"]
        if spec.number > len(elastic):
            rule = f"of the vibrations, from 1 to {len(elastic)}"
            raise InvalidParameterError(spec.quantity, "number", rule, spec.number)
        return float(found.data[column].values[elastic[spec.number - 1]])

    return find


def _response_gain(case: Case, spec: RequirementSpec) -> float:
    from antenna_pin.studies.linear import first_source, frequency_response

    found = _modes(case)
    source = spec.source or first_source(found, "source")
    response = frequency_response(found, source, spec.of)
    gain, frequency = response["gain"].values, response["frequency"].values
    if spec.band is not None:
        gain = gain[(frequency >= spec.band[0]) & (frequency <= spec.band[1])]
    return float(gain.max()) if gain.size else math.nan


def _of_small_motions() -> Iterator[VerifiedQuantity]:
    yield VerifiedQuantity(
        "frequency", "Hz", "natural frequency of a vibration about the start", "functional", "",
        _mode("frequency"), ("number",), needs_run=False,
    )  # fmt: skip
    yield VerifiedQuantity(
        "damping_ratio", "1", "damping ratio of a vibration about the start", "functional", "",
        _mode("damping_ratio"), ("number",), needs_run=False,
    )  # fmt: skip
    yield VerifiedQuantity(
        "response_gain", "", "largest gain of a frequency response about the start", "disturbance", "target",
        _response_gain, ("source", "band"), needs_run=False,
    )  # fmt: skip


# --- control: the sampled loop about the start ---


def _loop(column: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> float:
        from antenna_pin.studies.linear.sampled_loop import loop_margins

        name = f"loop {spec.of}"
        found = case.memo.get(name)
        if found is None:
            found = case.memo[name] = loop_margins(case.scenario, spec.of)
        return float(getattr(found, column))

    return find


def _of_loops() -> Iterator[VerifiedQuantity]:
    for name, units, meaning in (
        ("gain_margin", "1", "factor on the loop gain that makes the sampled loop unstable, the nearer way"),
        ("phase_margin", "rad", "least phase lag that makes the sampled loop unstable"),
        ("modulus_margin", "1", "least distance of the sampled loop's frequency response from -1"),
        ("loop_damping", "1", "least damping ratio of the closed sampled loop"),
        ("bandwidth", "Hz", "highest frequency at which the loop gain is 1"),
    ):
        yield VerifiedQuantity(name, units, meaning, "control", "controller", _loop(name), needs_run=False)


def _by_runs(kind: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        from antenna_pin.studies.verification.measurement import measured_gain_margin, measured_phase_margin

        if spec.of is None or spec.amplitude is None:
            missing = "of" if spec.of is None else "amplitude"
            rule = "given: a controller, and a sine's amplitude"
            raise InvalidParameterError(spec.quantity, missing, rule, None)
        measure = measured_phase_margin if kind == "phase" else measured_gain_margin
        margin, _ = measure(case.scenario, spec.of, spec.amplitude, spec.operating_point)
        return float(margin)

    return find


def _of_measured_loops() -> Iterator[VerifiedQuantity]:
    for kind, units in (("phase", "rad"), ("gain", "1")):
        yield VerifiedQuantity(
            f"measured_{kind}_margin", units,
            f"{kind} margin of a loop about an operating point in runs with sine references, through play",
            "control", "controller", _by_runs(kind), ("amplitude", "operating_point"), needs_run=False,
        )  # fmt: skip


# --- orders of a wheel, in runs at several speeds ---

# Orders as near are one [-]: a turn in the record's 20.
_SAME_ORDER = 0.05


def orders_of(case: Case, spec: RequirementSpec) -> Any:
    """Return the orders of a requirement's wheel, those that are found and the requirement's own."""
    from antenna_pin.analysis import wheel_orders
    from antenna_pin.studies.verification.measurement import records_at_speeds

    if spec.speeds is None:
        raise InvalidParameterError(
            spec.quantity, "speeds", "the lowest and the highest speed, as ['1000 rpm', '6000 rpm']", None
        )
    about = f"{spec.of} {spec.speeds} {spec.positions}"
    records = case.memo.get(f"speeds {about}")
    if records is None:
        more = {} if spec.positions is None else {"count": spec.positions}
        records = records_at_speeds(case.scenario, _joint(spec), spec.speeds, **more)
        case.memo[f"speeds {about}"] = records
    name = f"orders {about} {spec.harmonic}"
    if name not in case.memo:
        try:
            found = wheel_orders(records)
            orders = found["order"].values.tolist()
        except InvalidParameterError:
            found, orders = None, []
        if found is None or all(abs(one - spec.harmonic) > _SAME_ORDER for one in orders):
            found = wheel_orders(records, harmonics=[*orders, spec.harmonic])
        case.memo[name] = found
    return case.memo[name]


def _order(reduce: Callable[[Any], float], force: str, moment: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        if spec.axis is None:
            raise InvalidParameterError(spec.quantity, "axis", "one of fx, fy, fz, mx, my, mz", None)
        found = orders_of(case, spec).sel(axis=spec.axis).sel(order=spec.harmonic, method="nearest")
        return reduce(found), force if spec.axis.startswith("f") else moment

    return find


def _of_wheels() -> Iterator[VerifiedQuantity]:
    options = ("speeds", "positions", "harmonic", "axis")
    yield VerifiedQuantity(
        "order_coefficient", "", "C of a wheel's order, amplitude over the speed squared, resonances apart",
        "disturbance", "joint",
        _order(lambda orders: float(orders["coefficient"]), "kg m", "kg m^2"), options, needs_run=False,
    )  # fmt: skip
    yield VerifiedQuantity(
        "order_amplitude", "", "largest amplitude of an order of a wheel over its speeds", "disturbance",
        "joint", _order(lambda orders: float(orders["amplitude"].max()), "N", "N m"), options,
        needs_run=False,
    )  # fmt: skip


# --- motorization and statics ---


def _joint(spec: RequirementSpec) -> str:
    if spec.of is None:
        raise InvalidParameterError(spec.quantity, "of", "the name of a joint", None)
    return spec.of


def margin_of(case: Case, spec: RequirementSpec) -> Any:
    """Return the motorization margin of a requirement's joint."""
    from antenna_pin.studies.margins import margin

    travel = None if spec.travel is None else tuple(spec.travel)
    name = f"margin {spec.of} {travel} {spec.positions} {spec.factors}"
    if name not in case.memo:
        more: dict[str, Any] = {} if spec.positions is None else {"count": spec.positions}
        more |= {} if spec.factors is None else {"factors": spec.factors}
        case.memo[name] = margin(case.scenario, _joint(spec), travel=travel, **more)
    return case.memo[name]


def _motorization(case: Case, spec: RequirementSpec) -> Value:
    return float(margin_of(case, spec).smallest)


def loop_of(case: Case, spec: RequirementSpec) -> Any:
    """Return the torque-angle loop of a requirement's joint."""
    from antenna_pin.studies.statics import torque_angle_loop

    if spec.torque is None:
        raise InvalidParameterError(spec.quantity, "torque", "the amplitude of the loop, as '1 N*m'", None)
    name = f"loop {spec.of} {spec.torque} {spec.hold}"
    if name not in case.memo:
        case.memo[name] = torque_angle_loop(case.scenario, _joint(spec), spec.torque, hold=spec.hold)
    return case.memo[name]


def _of_loop(column: str, turning: str, sliding: str) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        found = loop_of(case, spec)
        return float(getattr(found, column)), sliding if found.sliding else turning

    return find


def _of_statics() -> Iterator[VerifiedQuantity]:
    yield VerifiedQuantity(
        "motorization_margin", "1", "smallest motorization margin over the travel, with the set's factors",
        "motorization", "joint", _motorization, ("travel", "positions", "factors"), needs_run=False,
    )  # fmt: skip
    for name, turning, sliding, meaning in (
        ("stiffness", "N m/rad", "N/m", "mean slope of the loaded branches of the torque-angle loop"),
        ("lost_motion", "rad", "m", "angle between the two senses of a small torque"),
        ("dead_band", "rad", "m", "part of a branch of the torque-angle loop without stiffness"),
        ("hysteresis", "rad", "m", "width of the torque-angle loop at zero torque"),
        ("loop_friction", "N m", "N", "half of the torque between the branches of the torque-angle loop"),
    ):
        column = name.removeprefix("loop_")
        yield VerifiedQuantity(
            name, "", meaning, "motorization", "joint", _of_loop(column, turning, sliding),
            ("torque", "hold"), needs_run=False,
        )  # fmt: skip


# --- contact stress, ratings, tolerance chains ---


def stress_of(case: Case) -> Any:
    """Return the contact stress of the run of a case."""
    from antenna_pin.analysis import contact_stress

    if "stress" not in case.memo:
        case.memo["stress"] = contact_stress(case.run)
    return case.memo["stress"]


def _surface(column: str, least: bool, kind: str = "") -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        rows = [one for one in stress_of(case).surfaces if kind in ("", one.surface)]
        mine = [
            one
            for one in rows
            if spec.of in (None, one.place) or one.place.startswith((f"{spec.of}.", f"bearings.{spec.of}."))
        ]
        if not mine:
            raise UnknownNameError(spec.quantity, "surface", spec.of or "any", [one.place for one in rows])
        # Of surfaces that met all must be known; others are without load.
        values = [float(getattr(one, column)) for one in mine if one.force != 0.0]
        if not values or any(map(math.isnan, values)):
            return 0.0 if not values and not least else math.nan
        return min(values) if least else max(values)

    return find


def _bearing(case: Case, spec: RequirementSpec) -> Value:
    rows = stress_of(case).bearings
    found = {one.place: -float(one.static_factor) for one in rows}
    return -chosen(spec.quantity, "ball bearing", spec.of, found)


def _bushing(case: Case, spec: RequirementSpec) -> Value:
    rows = stress_of(case).bushings
    return chosen(spec.quantity, "bushing", spec.of, {one.joint: float(one.pv) for one in rows})


def _chain(end: int) -> Find:
    def find(case: Case, spec: RequirementSpec) -> Value:
        from antenna_pin.scenario.assemble import tolerance_chain

        known = case.scenario.tolerances
        if spec.of is None and len(known) == 1:
            return float(tolerance_chain(case.scenario, next(iter(known))).worst_case[end])
        if spec.of not in known:
            raise UnknownNameError(spec.quantity, "tolerance chain", spec.of or "any", known)
        return float(tolerance_chain(case.scenario, spec.of).worst_case[end])

    return find


def _play(case: Case, spec: RequirementSpec) -> Value:
    from antenna_pin.scenario.assemble import joint_play

    return float(joint_play(case.scenario, _joint(spec)).radial)


def _of_contacts() -> Iterator[VerifiedQuantity]:
    yield VerifiedQuantity(
        "contact_pressure", "Pa", "largest pressure in the middle of a contact", "stress", "surface",
        _surface("pressure", False),
    )  # fmt: skip
    yield VerifiedQuantity(
        "contact_margin", "1", "least margin of safety of contact pressure against the yield limit", "stress",
        "surface", _surface("margin", True),
    )  # fmt: skip
    yield VerifiedQuantity(
        "line_load_ratio", "1", "largest load per length along a bore over its mean, at the peak pressure",
        "stress", "surface", _surface("line_load_ratio", False, "bore"), needs_series=True,
    )  # fmt: skip
    yield VerifiedQuantity(
        "static_factor", "1", "static safety factor of a ball bearing by ISO 76", "stress", "bearing",
        _bearing, needs_series=True,
    )  # fmt: skip
    yield VerifiedQuantity(
        "bushing_pv", "W/m^2", "largest product of mean pressure and sliding speed of a bushing", "stress",
        "joint", _bushing, needs_series=True,
    )  # fmt: skip
    for name, end, meaning in (
        ("chain_least", 0, "least sum of a tolerance chain, worst case"),
        ("chain_largest", 1, "largest sum of a tolerance chain, worst case"),
    ):
        yield VerifiedQuantity(name, "m", meaning, "preload", "chain", _chain(end), needs_run=False)
    yield VerifiedQuantity(
        "radial_play", "m", "radial play of a joint at its temperatures", "preload", "joint", _play,
        needs_run=False,
    )  # fmt: skip


def design_quantities() -> Iterator[VerifiedQuantity]:
    """Yield all quantities of scenarios and contacts."""
    for made in (
        _of_small_motions(), _of_loops(), _of_measured_loops(), _of_wheels(), _of_statics(), _of_contacts()
    ):  # fmt: skip
        yield from made
