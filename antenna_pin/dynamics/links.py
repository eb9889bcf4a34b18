"""Elements on links as blocks of a system's program: external and user-defined forces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import place_of
from antenna_pin.dynamics import kernels, link_kernels
from antenna_pin.dynamics import point_kernels as _points
from antenna_pin.dynamics.blocks import Blocks, check_booked, element_head
from antenna_pin.dynamics.constraints import Anchor, on_body
from antenna_pin.elements import FAMILIES, BetweenPoints, OnLinks, kind_of
from antenna_pin.elements import desk_kernels as _desk
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.mechanism import Mechanism, body_tree
from antenna_pin.mechanism.tree_kernels import place_bodies

Array = NDArray[np.float64]


# --- springs between points as blocks of a program, and their quantities in a state ---


def point_spring_block(mechanism: Mechanism, place: str, spring: BetweenPoints, x: int) -> Array:
    """Return the block of a spring between points.

    Raises:
        UnknownNameError: An unknown link.
        MechanismError: Both ends are on one body.
    """
    sides = np.zeros(2, dtype=_points.SIDE)
    for side, (link, point) in zip(sides, (spring.first, spring.second), strict=True):
        anchor = Anchor(link=link, rotation=np.eye(3), origin=np.array(point))
        side["body"], frame = on_body(mechanism, place, anchor)
        side["point"] = frame[:3, 3]
    if sides["body"][0] == sides["body"][1]:
        body = int(sides["body"][0])
        said = "the world" if body < 0 else f"body {mechanism.bodies[body]!r}"
        raise MechanismError(
            f"{place}: its links {spring.first[0]!r} and {spring.second[0]!r} are one body, {said}, so it "
            f"would have no effect; name links between which a joint moves"
        )
    words = spring.words_of_kernel()
    block = np.concatenate([np.zeros(kernels.PARAMETERS), words, sides.view(np.float64)])
    head = block[: kernels.PARAMETERS].view(kernels.ELEMENT)
    head["kind"], head["length"], head["x"] = kind_of(type(spring)), len(block), x
    head["on"] = spring.acts
    return block


assert _desk.HEAD_WORDS == kernels.PARAMETERS


class ForcePlace(NamedTuple):
    """A place at which a force acts."""

    name: str  # name of the force, with the link's if there are several
    force: str  # the force's name
    link: str  # the link, or ``world``
    point: tuple[float, float, float]  # in its frame [m]


class OnLinksInPython(NamedTuple):
    """Element on links whose Python function is called before each evaluation."""

    block: int  # place of its block in a program
    element: Any  # the element
    place: str  # name in messages
    nq: int  # start of v in a state

    @property
    def label(self) -> str:
        """Name in refusals."""
        return self.place

    def write(
        self, program: Array, t: float | None, y: Array, tree: NDArray[Any], places: NDArray[Any]
    ) -> None:
        """Write the element's action at time t [s] and state y to its desk."""
        place_bodies(y, self.nq, tree, places)
        desk = desk_in(program, self.block)
        now = float(desk[0]["time"][0]) if t is None else t
        link_kernels.see(now, y, program, self.block, places)
        self.element.ask(self.place, now, desk)


def written_by(program: Array, block: int) -> tuple[float, ...]:
    """Return the desk content of the element at a place in a program."""
    whole, links, joints, states = desk_in(program, block)
    parts = [links["force"], links["torque"], joints["torque"], states["rate"]]
    parts += [np.concatenate([whole["energy"], whole["loss"], whole["kink"]])]
    return tuple(np.concatenate([part.ravel() for part in parts]).tolist())


def desk_in(program: Array, block: int | None) -> tuple[Any, Any, Any, Any]:
    """Return a desk's views: whole, links, joints, states; without a block it stands first."""
    first = 0
    if block is not None:
        head = program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        first = block + int(head["partner"])
    whole = program[first : first + int(_desk.WHOLE_WORDS)].view(_desk.WHOLE).view(np.recarray)
    first += int(_desk.WHOLE_WORDS)
    parts = []
    for name, kind, words in (
        ("links", _desk.LINK, _desk.LINK_WORDS),
        ("joints", _desk.JOINT, _desk.SEEN_JOINT_WORDS),
        ("states", _desk.STATE, _desk.STATE_WORDS),
    ):
        end = first + int(whole[name][0]) * int(words)
        parts.append(program[first:end].view(kind).view(np.recarray))
        first = end
    return whole, parts[0], parts[1], parts[2]


def acting_on_links(system: Any, program: Array) -> Iterator[tuple[str, Array]]:
    """Yield last actions: link, force and moment about the world's origin, (6,)."""
    places = iter(system.force_places)
    for at in system.element_blocks.get("forces", {}).values():
        for one, place in zip(desk_in(program, at)[1], places, strict=False):
            moment = one["torque"] + np.cross(one["place"], one["force"])
            yield place.link, np.concatenate([one["force"], moment])


def books_in_x(system: Any) -> dict[str, NDArray[np.int_]]:
    """Return the indices in x of the integrals of forces, by ``BOOK`` name, (forces, ...)."""
    heads = [
        system.program[at : at + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        for at in system.element_blocks.get("forces", {}).values()
    ]
    starts = np.array([int(head["x"]) for head in heads], dtype=int)
    found = {}
    for name in _desk.BOOK.names or ():
        at = place_of(_desk.BOOK, name)
        many = _desk.BOOK[name].shape
        found[name] = starts[:, np.newaxis] + at + np.arange(3) if many else starts + at
    return found


def works_in_x(system: Any) -> NDArray[np.int_]:
    """Return the indices in x of works and gross works, (n, 2)."""
    drives = np.column_stack([system.work_x, system.gross_work_x])
    forces = np.column_stack([system.force_x["work"], system.force_x["gross_work"]])
    return np.concatenate([drives[(drives >= 0).all(axis=1)], forces]).astype(np.int64)


def place_on_links(system: Any, blocks: Blocks) -> int:
    """Append springs between points, then forces; return their places in the program.

    The system's ``element_blocks``, ``callables`` and ``force_places`` are extended.
    """
    begin = blocks.size
    for name, spring in system.point_springs.items():
        check_booked("spring", name, spring)
        block = point_spring_block(system.mechanism, f"spring {name!r}", spring, blocks.x)
        system.element_blocks["springs"][name] = blocks.add(block, len(spring.integrals))
    alone = ""
    for name, force in system.forces.items():
        place = f"{FAMILIES['forces'].word} {name!r}"
        if force.replaces_gravity:
            _check_gravity(system, place, alone)
            alone = place
        places = _places_of(system, name, force)
        block = _block(system, place, force, places, blocks.x)
        system.element_blocks["forces"][name] = at = blocks.add(block, len(force.integrals))
        system.force_places += places
        if getattr(force, "called", True) is False:
            system.callables.append(OnLinksInPython(at, force, place, system.model.nq))
    return begin


def _check_gravity(system: Any, place: str, other: str) -> None:
    gravity = system.model.gravity.linear
    if np.any(gravity):
        rule = "none beside what differs of it on an orbit, where all fall alike; take mechanism.gravity away"
        raise InvalidParameterError(place, "gravity", rule, gravity.tolist())
    if other:
        raise InvalidParameterError(place, "orbit", "the only one; remove one of the two", said=other)


def _places_of(system: Any, name: str, force: OnLinks) -> list[ForcePlace]:
    """Return the places that a force acts at."""
    if force.everywhere:
        mechanism = system.mechanism
        tree = body_tree(mechanism)
        found = []
        for body, one in zip(mechanism.bodies, tree, strict=True):
            frame = mechanism.model.frames[mechanism.frame(body)].placement
            x, y, z = map(float, frame.inverse().act(one["centre"]))
            found.append(ForcePlace(f"{name} {body}", name, body, (x, y, z)))
        return found
    several = len(force.places) > 1
    labels = [link for link, _ in force.places]
    return [
        ForcePlace(
            f"{name} {link}{_number(labels, k)}" if several else name,
            name,
            link,
            point,
        )
        for k, (link, point) in enumerate(force.places)
    ]


def _number(labels: list[str], k: int) -> str:
    """Return the suffix of a repeated link's name: nothing for the first, else its number."""
    before = labels[:k].count(labels[k])
    return f" {before + 1}" if before else ""


def _block(system: Any, place: str, force: OnLinks, places: list[ForcePlace], x: int) -> Array:
    """Return the block of an element on links.

    Raises:
        UnknownNameError: An unknown link or joint.
        MechanismError: It acts on no moving link.
    """
    tree = body_tree(system.mechanism)
    whole = np.zeros(1, _desk.WHOLE)
    whole["links"], whole["joints"] = len(places), len(force.joints)
    whole["states"] = len(force.states)
    whole["internal"], whole["passive"], whole["kink"] = force.internal, force.passive, 1.0
    links = np.zeros(len(places), _desk.LINK)
    for link, one in zip(links, places, strict=True):
        _lay_out(system, place, link, one.link, one.point, tree)
    if len(places) and not force.joints and np.all(links["body"] < 0):
        given = places[0].link
        raise MechanismError(
            f"{place}: link {given!r} does not move: it is the world or fixed to it, where a force has no "
            f"effect; name a link that a joint moves"
        )
    if force.internal and np.all(links["body"] == links["body"][0]):
        raise MechanismError(
            f"{place}: its links are all one body, and forces between them have no effect; name links "
            f"between "
            "which a joint moves"
        )
    if force.everywhere:
        links["axes"] = np.eye(3)
    joints = np.zeros(len(force.joints), _desk.JOINT)
    for joint, name in zip(joints, force.joints, strict=True):
        joint["head"] = element_head(system, place, name).view(np.float64)
    states = np.zeros(len(force.states), _desk.STATE)
    words = force.words_of_kernel()
    desk = [part.view(np.float64) for part in (whole, links, joints, states)]
    block = np.concatenate([np.zeros(kernels.PARAMETERS), words, *desk])
    head = block[: kernels.PARAMETERS].view(kernels.ELEMENT)
    head["kind"], head["length"], head["x"] = kind_of(type(force)), len(block), x
    head["partner"] = kernels.PARAMETERS + len(words)
    head["on"] = force.acts
    return block


def _lay_out(
    system: Any, place: str, link: Any, name: str, point: tuple[float, float, float], tree: NDArray[Any]
) -> None:
    """Write which body a link is of, and where on it a point is."""
    anchor = Anchor(link=name, rotation=np.eye(3), origin=np.array(point))
    link["body"], frame = on_body(system.mechanism, place, anchor)
    link["axes"], link["point"] = frame[:3, :3], frame[:3, 3]
    if link["body"] >= 0:
        own = tree[link["body"]]
        link["mass"], link["inertia"] = own["mass"], own["inertia"]
