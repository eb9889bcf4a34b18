"""Workspace of the derivatives of joints with play."""
# ruff: noqa: D102 - a comment stands beside each property

from __future__ import annotations

from typing import NamedTuple, Protocol

from antenna_pin.base.records import Contact, Floats, Indices2, Ints, Memory, Pose, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.integrate.difference_kernels import Words


class Part(Record):
    """A joint with play (``element`` 0) or an element at joints, with its arguments."""

    element: int  # 1: an element, 0: a joint with play
    number: int  # among these
    block: int  # in the program
    v: Indices2  # starts of the freedoms in v, of its joint and of the other joint
    freedoms: Indices2  # of both; 0: there is no other
    factor: Indices2  # of the configuration space, of both
    x: int  # start of its integrals in x
    x_end: int  # their end
    bristle: int  # first of its bristles, among all
    bristle_end: int  # behind its last


PART = layout(Part)


@by_address
class LawWords(NamedTuple):
    """Law parameters in a program that depend on system numbers, contact by contact.

    Attributes:
        first: Start of those of each contact, and the end, (contacts + 1,).
        at: Places in the program, (words,).
        slopes: Their changes, (words, numbers).
        steps: First steps of differences, (words,).
    """

    first: Ints
    at: Ints
    slopes: Floats
    steps: Floats


class Contacts(Protocol):
    """The contacts of a system."""

    @property
    def memory(self) -> Records[Memory]: ...  # of the moment

    @property
    def own(self) -> Records[Contact]: ...  # table that the derivative of the state has written

    @property
    def table(self) -> Records[Contact]: ...  # scratch


class JointShifts(Protocol):
    """Changes of a joint's numbers with parameters, and with the discrete state of elements."""

    @property
    def program(self) -> Words: ...  # words of the program

    @property
    def acts(self) -> Ints: ...  # kind of change of each part, 0: none, (parts + 1, numbers)

    @property
    def steps(self) -> Floats: ...  # first steps of differences, (numbers,)

    @property
    def rules(self) -> LawWords: ...  # numbers of contacts' laws

    @property
    def laws(self) -> Floats: ...  # derivatives of laws over these, (contacts, words, kinds, said)


class JointRoom(Protocol):
    """The part of ``dynamics.tangent_room_kernels.TangentRoom`` that joints with play use."""

    @property
    def numbers(self) -> Contacts: ...  # of the system

    @property
    def weights(self) -> Floats: ...  # of differences at 1, 2, ... steps, of each kind, (kinds, points)

    @property
    def layout(self) -> Ints: ...  # of the manifold

    @property
    def bristles(self) -> Ints: ...  # their places in x, (bristles,)

    @property
    def bristle_of(self) -> Ints: ...  # bristle at each place of x, -1: none, (nx,)

    @property
    def units(self) -> Floats: ...  # of displacements, rates and bristles, (2 nv + bristles,)

    @property
    def asks(self) -> Ints: ...  # variables of differentiation: REMEMBERED, TIMES, (2,)

    @property
    def state(self) -> Floats: ...  # where it is displaced, scratch, (1, size)

    @property
    def step(self) -> Floats: ...  # of displacements, scratch, (nv,)

    @property
    def tau(self) -> Floats: ...  # generalized force, scratch, (nv,)

    @property
    def poses(self) -> Records[Pose]: ...  # of a journal as it is, its changes, and displaced, (3,)

    @property
    def remembered(self) -> Records[Memory]: ...  # scratch, (1,)

    @property
    def looked(self) -> Floats: ...  # values of a function, scratch, (values,)

    @property
    def change(self) -> Floats: ...  # of a contact, scratch, (kinds, LOOKED)

    @property
    def shapes(self) -> Floats: ...  # changes of its dimensions, and these displaced, (2, CANDIDATE)

    @property
    def wrench(self) -> Floats: ...  # change of force and moment of a joint's contacts, (kinds, 6)

    @property
    def carried(self) -> Floats: ...  # these along freedoms as the joint's frames change, (6,)

    @property
    def trial(self) -> Floats: ...  # differences, scratch, (kinds + 2, values)

    @property
    def middle(self) -> Floats: ...  # values of a law undisplaced, scratch, (values,)

    @property
    def asked(self) -> Floats: ...  # arguments of laws, scratch

    @property
    def said(self) -> Floats: ...  # their values, scratch

    @property
    def laws(self) -> Floats: ...  # derivatives of laws, (contacts of a joint, asked, kinds, said)

    @property
    def first_number(self) -> Ints: ...  # place in a displacement of the system's numbers, (1,)

    @property
    def seen(self) -> Ints: ...  # those of these that act on a joint, scratch, (numbers,)

    @property
    def shifts(self) -> JointShifts: ...  # changes with these numbers
