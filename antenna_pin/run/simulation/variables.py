"""Variables of a result, source by source, from blocks of samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import (
    Deflections,
    Observed,
    System,
    bearing_loads,
    deflections,
    joint_motion,
    journal_attitudes,
    kernels,
    records_at,
    sliding_motion,
)
from antenna_pin.elements import BristleFriction, Motion, Motor
from antenna_pin.run.simulation.loop import Run
from antenna_pin.trajectory.quantities import SUMMARIES

Array = NDArray[np.float64]

# --- samples with the quantities that they imply ------------------------------------------------------------

# Variables of the ledger, by their places in x; further below the signs of those in the balance.
_LEDGER = {
    "drive_work": "work_x",
    "drive_gross_work": "gross_work_x",
    "dissipation_normal": "lost_normal_x",
    "dissipation_friction": "lost_friction_x",
    "normal_impulse": "impulse_x",
    "dissipation_damper": "damper_x",
    "dissipation_elastic": "damper_x",
    "element_loss": "element_x",
}
# Variables of forces by their integrals.
_OF_FORCES = {
    "force_work": "work",
    "force_gross_work": "gross_work",
    "force_loss": "loss",
    "force_impulse": "impulse",
    "force_angular_impulse": "angular_impulse",
    "force_central_impulse": "central_impulse",
}
_BALANCE = {
    "drive_work": -1.0,
    "dissipation_normal": 1.0,
    "dissipation_friction": 1.0,
    "dissipation_damper": 1.0,
    "dissipation_elastic": 1.0,
    "element_loss": 1.0,
    "force_work": -1.0,
    "force_loss": 1.0,
}


@dataclass(frozen=True, slots=True, eq=False)
class BlockEnd:
    """Data of the samples before a block."""

    first: Array  # state [q, v, x] of the run's first sample
    stored: float  # stored energy at the first sample [J]
    state: Array  # state [q, v, x] at this end of the block
    attitudes: Array  # attitudes of the journals there, (joints, 4)


@dataclass(eq=False)
class SampleBlock:
    """Consecutive samples of a run, with the observed quantities of the system."""

    run: Run
    times: Array  # times, (n,) [s]
    states: Array  # states [q, v, x], (n, nq + nv + nx)
    memories: NDArray[Any]  # contact memory, MEMORY, (n, contacts)
    programs: Sequence[Array]  # program of force elements of each sample
    found: Observed  # quantities by the equations of motion
    before: BlockEnd | None = None  # end of the previous block; None for the first

    @property
    def start(self) -> BlockEnd:
        """First sample of the run; before the impulses of the start, if any."""
        if self.before is None:
            first, stored = self.states[0].copy(), float(self.found.energy[0])
            for x, loss in self.run.actions.modes.lost_at_start() if self.times[0] == 0.0 else ():
                first[x] -= loss
                stored += loss
            return self._edge(0, first, stored)
        return BlockEnd(self.before.first, self.before.stored, self.before.first, np.zeros((0, 4)))

    @property
    def end(self) -> BlockEnd:
        """Last of these samples."""
        return self._edge(-1, self.start.first, self.start.stored)

    def _edge(self, place: int, origin: Array, stored: float) -> BlockEnd:
        return BlockEnd(origin.copy(), stored, self.states[place].copy(), self.attitudes[place].copy())

    @cached_property
    def attitudes(self) -> Array:
        """Attitudes of journals, quaternions without jumps in sign, (n, joints, 4)."""
        before = None if self.before is None else (self.before.state, self.before.attitudes)
        return journal_attitudes(self.system, self.states, self.programs, before)

    @property
    def system(self) -> System:
        """System of the run."""
        return self.run.system

    @property
    def q(self) -> Array:
        """Configurations, (n, nq)."""
        return self.states[:, : self.system.model.nq]

    @property
    def v(self) -> Array:
        """Generalized velocities, (n, nv)."""
        nq = self.system.model.nq
        return self.states[:, nq : nq + self.system.model.nv]

    @cached_property
    def ledger(self) -> dict[str, Array]:
        """Integrals of the elements since the first sample of this run."""
        behind = self.system.model.nq + self.system.model.nv
        grown = self.states[:, behind:] - self.start.first[behind:]
        grown = np.column_stack([grown, np.zeros(len(grown))])  # last column for elements without integrals
        places = {name: getattr(self.system, place) for name, place in _LEDGER.items()}
        others = len(self.system.springs) - len(self.system.elastic)  # elastic parts come last
        places["dissipation_damper"] = places["dissipation_damper"][:others]
        places["dissipation_elastic"] = places["dissipation_elastic"][others:]
        places |= {name: self.system.force_x[of] for name, of in _OF_FORCES.items()}
        return {name: grown[:, columns] for name, columns in places.items()}

    @cached_property
    def joints(self) -> tuple[list[str], Array]:
        """Names and motion of the joints that turn."""
        return joint_motion(self.system, self.states, self.found.acceleration, self.programs)

    @cached_property
    def slides(self) -> tuple[list[str], Array]:
        """Names and motion of the joints that slide."""
        return sliding_motion(self.system, self.states, self.found, self.programs)

    @cached_property
    def elastic(self) -> Deflections:
        """Motion and energy of the elastic parts."""
        return deflections(self.system, self.states, self.found.acceleration, self.programs)

    @cached_property
    def spring_energy(self) -> Array:
        """Energy in springs except elastic parts, and in cogging of motors, (n,) [J]."""
        cogs = any(isinstance(one, Motor) and one.cogging > 0.0 for one in self.system.drives.values())
        if len(self.system.springs) == len(self.system.elastic) and not cogs:
            return np.zeros(len(self.times))  # not the round-off of a difference
        others = self.elastic.energy.sum(axis=1) + self.found.kept.sum(axis=1)
        return np.asarray(self.found.audit["springs"] - others)

    def kept_momentum(self, name: str) -> Array:
        """Return the conserved part of a momentum, ``linear`` or ``angular``."""
        impulse = self.ledger[{"linear": "force_impulse", "angular": "force_central_impulse"}[name]]
        return np.asarray(self.found.audit[name] - impulse.sum(axis=1))

    @cached_property
    def energy_error(self) -> Array:
        """Error of the energy balance [J]."""
        stored = self.found.energy
        error = stored - self.start.stored
        for happening in self.run.actions.happened:
            error[self.times >= happening.time] -= happening.energy
        for name, sign in _BALANCE.items():
            error += sign * self.ledger[name].sum(axis=1)
        return np.asarray(error)


# --- bristles -----------------------------------------------------------------------------------------------


def bristles_of(block: SampleBlock, state: str) -> list[str]:
    """Return the frictions with a state of this name, by family and name."""
    return [place for place, _, _ in _with(block, state)]


def of_bristles(block: SampleBlock) -> Mapping[str, Any]:
    """Return the series of bristles."""
    layout = BristleFriction.layout()
    bends = [
        records_at(block.programs, words, layout)["start"] + block.states[:, at]
        for _, at, words in _with(block, "bend")
    ]
    dwells = [block.states[:, at] for _, at, _ in _with(block, "dwell")]
    shape = len(block.times), 0
    return {
        "bristle_bend": np.column_stack(bends) if bends else np.zeros(shape),
        "bristle_dwell": np.column_stack(dwells) if dwells else np.zeros(shape),
    }


def _with(block: SampleBlock, state: str) -> list[tuple[str, int, int]]:
    """Return place, index in the state, and record's offset of frictions with this state."""
    system, found = block.system, []
    for name, friction in system.families.get("frictions", {}).items():
        own = [one.name for one in friction.integrals]
        if isinstance(friction, BristleFriction) and state in own:
            offset = system.element_blocks["frictions"][name]
            head = system.program[offset : offset + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
            at = system.model.nq + system.model.nv + int(head["x"]) + own.index(state)
            found.append((f"frictions.{name}", at, offset + int(kernels.PARAMETERS)))
    return found


# --- motors -------------------------------------------------------------------------------------------------

#: Series that count from the run's first sample on.
MOTORS_SINCE_BEGIN = ("motor_electric_energy", "motor_heat")


def motors_of(block: SampleBlock) -> list[str]:
    """Return the drives that are motors, by name."""
    return [name for name, drive in block.system.drives.items() if isinstance(drive, Motor)]


def of_motors(block: SampleBlock) -> Mapping[str, Any]:
    """Return the series of motors."""
    names = motors_of(block)
    shape = len(block.times), len(names)
    current, electric, heat = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    behind = block.system.model.nq + block.system.model.nv
    for k, name in enumerate(names):
        motor = block.system.drives[name]
        assert isinstance(motor, Motor)
        offset = block.system.drive_blocks[name]
        head = block.system.program[offset : offset + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        places = {one.name: behind + int(head["x"]) + j for j, one in enumerate(motor.integrals)}
        since = block.states - block.start.first
        electric[:, k], heat[:, k] = since[:, places["electric"]], since[:, places["heat"]]
        if motor.inductance > 0.0:
            current[:, k] = block.states[:, places["current"]]
        else:
            current[:, k] = _algebraic(block, motor, name)
    return {"motor_current": current, "motor_electric_energy": electric, "motor_heat": heat}


def _algebraic(block: SampleBlock, motor: Motor, name: str) -> Array:
    """Return the current of a motor without inductance, from its torque; 0 if off [A]."""
    offset = block.system.drive_blocks[name]
    on = records_at(block.programs, offset, kernels.ELEMENT)["on"]
    own = records_at(block.programs, offset + int(kernels.PARAMETERS), Motor.layout())
    torque = block.found.effort["effort"][:, list(block.system.drives).index(name)] / own["ratio"]
    names, motion = block.slides if block.system.slides(motor.joint) else block.joints
    turned = own["ratio"] * motion[names.index(motor.joint), :, 0]
    cogging = -own["cogging"] * np.sin(own["cycles"] * turned + own["cogging_phase"])
    return np.where(on == 0.0, 0.0, (torque - cogging) / own["torque_constant"])


# --- sources ------------------------------------------------------------------------------------------------

Values = Mapping[str, Any]


def _state(block: SampleBlock) -> Values:
    q, v = block.q, block.v
    return {
        "q": q,
        "v": v,
        "base_position": q[:, :3],
        "base_attitude": q[:, 3:7],
        "base_velocity": v[:, :3],
        "base_angular_velocity": v[:, 3:6],
    }


def _derivative(block: SampleBlock) -> Values:
    effort = block.found.effort
    stretch = block.found.stretch
    tracking = effort[:, [drive.tracks for drive in block.system.drives.values()]]
    return {
        "a": block.found.acceleration,
        "drive_torque": effort["effort"],
        "control_reference": tracking["reference"],
        "control_error": tracking["error"],
        "element_effort": block.found.done["effort"],
        "element_deflection": block.found.done["deflection"],
        "element_energy": block.found.done["energy"],
        "element_mode": block.found.done["mode"].astype(np.int8),
        "spring_torque": block.found.traced["effort"],
        "spring_length": stretch["length"],
        "spring_tension": stretch["tension"],
        "spring_force": stretch["force"],
        "applied_force": block.found.applied["force"],
        "applied_torque": block.found.applied["torque"],
        "force_energy": block.found.kept,
        "closure_force": block.found.closure[:, :, 0],
        "closure_moment": block.found.closure[:, :, 1],
        "coupling_torque": block.found.coupling,
    }


def _contact(block: SampleBlock) -> Values:
    contacts, pose = block.found.contact, block.found.pose
    axis = pose["axis"]
    return {
        **{name: contacts[name] for name in contacts.dtype.names or ()},
        "touching": block.memories["touching"].astype(np.int8),
        "journal_position": pose["centre"],
        "journal_attitude": block.attitudes,
        "journal_tilt": np.arctan2(np.hypot(axis[..., 0], axis[..., 1]), axis[..., 2]),
        "joint_force": pose["force"],
        "joint_torque": pose["moment"],
        "radial_scenario": block.found.scenario[:, :, 0],
        "axial_scenario": block.found.scenario[:, :, 1],
    }


def _bearing(block: SampleBlock) -> Values:
    loads = bearing_loads(block.system, block.states, block.programs)
    return {f"bearing_{name}": loads[name] for name in loads.dtype.names or ()}


def _ledger(block: SampleBlock) -> Values:
    return {**block.ledger, "energy_error": block.energy_error}


def _audit(block: SampleBlock) -> Values:
    audit = block.found.audit
    return {
        "kinetic_energy": audit["kinetic"],
        "contact_energy": audit["contacts"],
        "spring_energy": block.spring_energy,
        "elastic_energy": block.elastic.energy,
        "gravity_energy": audit["gravity"],
        "linear_momentum": audit["linear"],
        "angular_momentum": audit["angular"],
        "momentum_scale": audit["linear_scale"],
        "angular_momentum_scale": audit["angular_scale"],
    }


def _motion(block: SampleBlock) -> Values:
    turning = block.joints[1]
    sliding = block.slides[1]
    return {
        "motion_angle": turning[:, :, 0].T,
        "motion_rate": turning[:, :, 1].T,
        "motion_acceleration": turning[:, :, 2].T,
        "slide_position": sliding[:, :, 0].T,
        "slide_rate": sliding[:, :, 1].T,
        "slide_acceleration": sliding[:, :, 2].T,
        "deflection": block.elastic.motion[:, :, 0],
        "deflection_rate": block.elastic.motion[:, :, 1],
        "deflection_acceleration": block.elastic.motion[:, :, 2],
    }


def _reductions(by: str) -> dict[str, str]:
    return {one.name: one.reduced.of for one in SUMMARIES if one.reduced and one.reduced.by == by}


#: Totals, the last values of these series.
TOTALS = _reductions("end")
#: Peaks, the largest sizes of these series at samples: of vectors their length.
SIZES = {**_reductions("peak"), "peak_energy_error": "energy_error"}


def sizes_of(block: SampleBlock, values: Values) -> Values:
    """Return the sizes at samples of all variables with a recorded peak."""
    sizes = {
        name: np.linalg.norm(values[of], axis=2) if values[of].ndim == 3 else np.abs(values[of])
        for name, of in SIZES.items()
    }
    motions = [isinstance(drive, Motion) for drive in block.system.drives.values()]
    sizes["peak_effort"] = sizes["peak_effort"][:, motions]
    return {**sizes, "peak_spin": block.elastic.spin, "peak_residual": block.found.residual}


_OF_EPISODES = ("approach_speed", "peak_force", "peak_time", "peak_depth", "impulse", "dissipated")
_OF_CHANGES = (
    *("time", "angle", "rate", "rate_after", "loss", "impulse", "energy", "peak_effort", "peak_time"),
)


def episodes_of(run: Run) -> Values:
    """Return the record of contacts, changes of mode and events."""
    episodes, happened = run.episodes, run.actions.happened
    changed = [one for one in run.actions.modes.recorded() if one.time > run.after]
    names = {"onset_time": "onset", "release_time": "release", **{name: name for name in _OF_EPISODES}}
    names |= {"effective_mass": "effective_mass", "episode_contact": "contact"}
    return {
        **{name: episodes[of].copy() for name, of in names.items()},
        **{
            f"change_{of}": np.array([getattr(one, of) for one in changed], dtype=float) for of in _OF_CHANGES
        },
        "event_time": np.array([one.time for one in happened], dtype=float),
        "event_energy": np.array([one.energy for one in happened], dtype=float),
    }


#: The series, by source: all variables of each.
SERIES: tuple[Callable[[SampleBlock], Values], ...] = (
    _state,
    of_bristles,
    _derivative,
    of_motors,
    _contact,
    _bearing,
    _audit,
    _ledger,
    _motion,
)
