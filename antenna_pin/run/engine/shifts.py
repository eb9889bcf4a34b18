"""Derivatives of a system's numbers with respect to parameters, laid out for the rates' derivatives."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import BLOCK, PROGRAM, place_of, words_of
from antenna_pin.compiled.decorators import in_python
from antenna_pin.dynamics import System, kernels
from antenna_pin.dynamics.constraints import layout_kernels as layout_of_rows
from antenna_pin.dynamics.tangent_kernels import FRAMES, ITSELF
from antenna_pin.dynamics.tangent_room_kernels import Shifts
from antenna_pin.integrate.difference_kernels import Words
from antenna_pin.joints import layout_kernels, motion_change_kernels
from antenna_pin.joints.geometry.kernels import CANDIDATE
from antenna_pin.joints.tangent_room_kernels import LawWords
from antenna_pin.mechanism import BODY
from antenna_pin.run.engine.compiled import CompiledStepper

Array = NDArray[np.float64]

# First steps of differences, relative to the scale of a number.
_STEP = 1e-3
# Number of packed parameters of a contact's laws.
_LAWS = layout_kernels.CANDIDATE_WORDS - CANDIDATE
# Parameters of a body that affect its motion, not its place.
_INERTIAL = ("mass", "centre", "inertia", "armature")


class SystemSlopes(NamedTuple):
    """Change of the numbers of a system with parameters, each in its scale.

    Attributes:
        program: Change of its program, (parameters, words).
        tree: Change of its bodies, flat, (parameters, words).
        plan: Change of its constraints, (parameters, words).
        gravity: (parameters, 3) [m/s^2].
        kept: Words of the program that are coordinates of a state themselves, (kept,).
        units: Scales of these, (kept,).
    """

    program: Array
    tree: Array
    plan: Array
    gravity: Array
    kept: NDArray[np.int_]
    units: Array


def takes_slopes(system: System, slopes: SystemSlopes) -> bool:
    """Return whether changes of bodies' and constraints' numbers have a known derivative: not of axes."""
    if system.plan is not None:
        driven = slopes.plan[:, system.plan.parts.motions]
        axes = place_of(layout_of_rows.DRIVEN, "axes")
        for first in range(axes, driven.shape[1], layout_of_rows.DRIVEN_WORDS):
            if driven[:, first : first + 9].any():
                return False
    bodies = slopes.tree.reshape(len(slopes.tree), slopes.tree.shape[1] // words_of(BODY), words_of(BODY))
    first = place_of(BODY, "axis")
    return not bodies[:, :, first : first + 3].any()


def moves_rows(system: System, program: Array, plan: Array) -> NDArray[np.bool_]:
    """Return which numbers may affect residuals of constraints, (numbers,).

    Args:
        system: The system, with constraints.
        program: Change of its program, (numbers, words).
        plan: Change of its constraints, (numbers, words).
    """
    assert system.plan is not None
    if system.callables:  # the functions of these are not known
        return np.ones(len(plan), dtype=bool)
    changed, parts = plan != 0.0, system.plan.parts
    bodies = changed[:, parts.tree].reshape(len(plan), -1, words_of(BODY))
    for name in _INERTIAL:
        first = place_of(BODY, name)
        bodies[:, :, first : first + words_of(BODY[name])] = False
    changed[:, parts.tree] = bodies.reshape(len(plan), -1)
    moved = changed.any(axis=1)
    for driven in (parts.motions, parts.holds):
        moved |= _driven_otherwise(system, program != 0.0, driven)
    return np.asarray(moved)


def shifts_of(
    system: System,
    stepper: CompiledStepper,
    parts: NDArray[Any],
    law_outputs: int,
    slopes: SystemSlopes,
) -> Shifts:
    """Return them, laid out."""
    numbers, nv = stepper.numbers, stepper.manifold.nv
    own = np.zeros((len(slopes.kept), len(numbers.program)))
    own[np.arange(len(own)), slopes.kept] = 1.0
    program = np.concatenate([slopes.program, own])
    tree, plan, gravity = (
        np.concatenate([one, np.zeros((len(own), one.shape[1]))])
        for one in (slopes.tree, slopes.plan, slopes.gravity)
    )
    count, contacts = len(program), len(numbers.memory)
    closures, couplings = _row_slopes(system, plan)
    motions = np.zeros(count, dtype=bool)
    if system.plan is not None:
        motions = _driven_otherwise(system, program.astype(bool), system.plan.parts.motions)
    heavy = tree.any(axis=1) | gravity.any(axis=1) | motions
    if system.plan is not None:
        heavy |= plan[:, system.plan.parts.closures].any(axis=1)
        heavy |= plan[:, system.plan.parts.couplings].any(axis=1)
    width = 0 if system.plan is None else in_python(layout_of_rows.plan_of)(system.plan.words).width
    steps = np.concatenate([np.full(len(slopes.program), _STEP), _STEP * slopes.units])
    rules = _rules(system, program, steps, contacts)
    return Shifts(
        program=_words(program),
        tree=_words(tree),
        flat=numbers.tree.view(np.float64).reshape(-1),
        bodies=tree.reshape(count, len(numbers.tree), words_of(BODY)).view(BODY)[:, :, 0],
        gravity=gravity,
        heavy=heavy.astype(np.int64),
        closures=closures,
        couplings=couplings,
        motions=motions.astype(np.int64),
        lacks=np.zeros((count, 2, width)),
        acts=_acts(system, parts, program.astype(bool), np.asarray(tree.any(axis=1))),
        steps=steps,
        rules=rules,
        laws=np.zeros((contacts, int(np.diff(rules.first).max(initial=0)), 2, law_outputs)),
        forces=np.zeros((count, nv)),
    )


def _row_slopes(system: System, plan: Array) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return by how much closures' and couplings' own numbers change, (numbers, ...) each."""
    kinds = layout_of_rows.CLOSURE, layout_of_rows.COUPLED
    if system.plan is None:
        return np.zeros((len(plan), 0), kinds[0]), np.zeros((len(plan), 0), kinds[1])
    parts = system.plan.parts
    closures, couplings = (np.ascontiguousarray(plan[:, one]) for one in (parts.closures, parts.couplings))
    return closures.view(kinds[0]), couplings.view(kinds[1])


def _driven_otherwise(system: System, changed: NDArray[np.bool_], driven: slice) -> NDArray[np.bool_]:
    """Return which numbers affect elements that move or hold joints, (numbers,).

    ``changed``, (numbers, words), is the dependence of the program; records of joints start at ``driven``.
    """
    assert system.plan is not None
    moved = np.zeros(len(changed), dtype=bool)
    for one in system.plan.words[driven].view(layout_of_rows.DRIVEN):
        block = int(one["words"]) - int(kernels.PARAMETERS)
        moved |= changed[:, block : block + _length(system.program, block)].any(axis=1)
    return moved


def _words(slopes: Array) -> Words:
    """Return which numbers change, and by how much."""
    found = [np.flatnonzero(one) for one in slopes]
    first = np.cumsum([0, *(len(one) for one in found)])
    at = np.concatenate([np.zeros(0, dtype=np.int64), *found]).astype(np.int64)
    changes = np.concatenate([np.zeros(0), *(one[places] for one, places in zip(slopes, found, strict=True))])
    return Words(first.astype(np.int64), at, changes, np.zeros(len(at)))


def _rules(system: System, changes: Array, steps: Array, contacts: int) -> LawWords:
    """Return which numbers of contacts' laws change, and by how much."""
    found: list[NDArray[np.int_]] = [np.zeros(0, dtype=int)] * contacts
    for block in system.clearance_blocks.values():
        joint = system.program[block:][: layout_kernels.JOINT_WORDS].view(layout_kernels.JOINT)[0]
        for k in range(int(joint["contacts"])):
            laws = np.arange(_LAWS) + layout_kernels.normal_at(block, k)
            found[int(joint["row"]) + k] = laws[changes[:, laws].any(axis=0)]
    first = np.cumsum([0, *(len(one) for one in found)]).astype(np.int64)
    at = np.concatenate([np.zeros(0, dtype=np.int64), *found]).astype(np.int64)
    slopes = np.ascontiguousarray(changes[:, at].T)
    return LawWords(first, at, slopes, np.abs(slopes * steps).max(axis=1, initial=0.0))


def _acts(
    system: System, parts: NDArray[Any], changed: NDArray[np.bool_], heavier: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Return the dependence of each part on each number, (parts + 1, numbers)."""
    program, out = system.program, np.zeros((len(parts) + 1, len(changed)), dtype=np.int64)
    for p, part in enumerate(parts):
        block = int(part["block"])
        whole = changed[:, block : block + _length(program, block)]
        if part["element"]:
            out[p] = ITSELF * whole.any(axis=1)
            frames = np.zeros(len(changed), dtype=bool)
            for joint in _joints_known(system, block):
                frames |= changed[:, joint : joint + layout_kernels.JOINT_WORDS].any(axis=1)
            out[p] += FRAMES * frames
            continue
        laws = np.zeros(whole.shape[1], dtype=bool)
        joint_words = program[block:][: layout_kernels.JOINT_WORDS].view(layout_kernels.JOINT)[0]
        for k in range(int(joint_words["contacts"])):
            normal = layout_kernels.normal_at(0, k)
            laws[normal : normal + _LAWS] = True
        out[p] = motion_change_kernels.RULES * whole[:, laws].any(axis=1)
        laws[: layout_kernels.JOINT_WORDS] = True
        out[p] += motion_change_kernels.PLACES * whole[:, : layout_kernels.JOINT_WORDS].any(axis=1)
        out[p] += motion_change_kernels.MOVES * whole[:, ~laws].any(axis=1)
    first = int(program[: kernels.HEADER].view(PROGRAM)[0]["points"])
    out[-1] = changed[:, first:].any(axis=1) | heavier
    # Elements on links may depend on any joint with play.
    for block in system.clearance_blocks.values():
        out[-1] |= changed[:, block : block + _length(program, block)].any(axis=1)
    return out


def _length(program: Array, block: int) -> int:
    """Return how many words a block of a program has."""
    return int(program[block:][: kernels.BLOCK_WORDS].view(BLOCK)[0]["length"])


def _joints_known(system: System, block: int) -> list[int]:
    """Return the blocks of the joints with play that an element acts at, or sees."""
    heads = [head_in(system, block)]
    if other := int(heads[0]["partner"]) or int(heads[0]["sensed"]):
        heads.append(head_in(system, block + other))
    return [int(one["play"]) for one in heads if one["play"] >= 0]


def head_in(system: System, block: int) -> np.void:
    """Return the head of an element in a system's program."""
    return np.void(system.program[block:][: kernels.PARAMETERS].view(kernels.ELEMENT)[0])
