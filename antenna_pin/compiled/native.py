"""Loader of the shim to Pinocchio's and coal's machine code (``antenna_pin/native/shim.h``).

Compiled loops call the shim's functions by address, without the interpreter and its lock. It is used if its
file is in the package and was compiled against the installed versions of Pinocchio and coal, with the
instruction set of their bindings; otherwise Python is called instead, with the same results to the last bit.
:func:`native_state` returns the state.

``ANTENNA_PIN_NATIVE=off`` disables it, ``ANTENNA_PIN_NATIVE=required`` refuses to run without it.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import importlib.metadata
import os
import sys
import weakref
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.calls import call_back
from antenna_pin.compiled.native_build import FOLDER, NAME, built_of, digest_of_sources, prefix_of
from antenna_pin.compiled.ownership import open_to, stranger_of
from antenna_pin.errors import InvalidParameterError, MissingToolError

_VARIABLE = "ANTENNA_PIN_NATIVE"
_INTERFACE = 1

# Rotated shape of a pair, as in shim.h.
NOT_TURNED, FIRST_TURNED, SECOND_TURNED, PLANE_GIVEN = range(4)

# C++ types whose addresses the bindings give, by their mangled names.
_MODEL = b"N9pinocchio8ModelTplIdLi0ENS_25JointCollectionDefaultTplEEE"
_FUNCTOR = b"N4coal15ComputeDistanceE"
_REQUEST = b"N4coal15DistanceRequestE"
_HALFSPACE = b"N4coal9HalfspaceE"


class _TreeArrays(ctypes.Structure):
    """``ApinTreeArrays``."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("state", "effort", "acceleration", "mass", "bias")]


class _PairAddresses(ctypes.Structure):
    """``ApinPair``."""

    _fields_ = [
        *((name, ctypes.c_void_p) for name in ("functor", "request", "plane")),
        *((name, ctypes.c_int64) for name in ("turned", "bit")),
        *((name, ctypes.c_void_p) for name in ("asked", "first", "second", "turn")),
        *((name, ctypes.c_void_p) for name in ("distance", "normal", "point")),
    ]


class ShapePair(NamedTuple):
    """Two of coal's shapes, and the arrays of a query of their distance.

    Attributes:
        functor: ``coal.ComputeDistance`` of the shapes.
        request: ``coal.DistanceRequest``.
        asked: Whole number whose bit requests the pair, (1,).
        bit: That bit.
        distance: Result [m], (1,).
        normal: Result, from the first to the second shape, (3,).
        point: Result, nearest point of the first shape [m], (3,); None if not wanted.
        first: Place of the first shape [m], (3,); None at the origin.
        second: Likewise of the second shape.
        turned: ``FIRST_TURNED`` or ``SECOND_TURNED`` by ``turn``, ``NOT_TURNED``, or ``PLANE_GIVEN``.
        turn: Rotation, (3, 3); of ``PLANE_GIVEN`` normal and distance of the plane, (4,).
        plane: ``coal.Halfspace`` of ``PLANE_GIVEN``.
        shapes: Shapes that must outlive the functor.
    """

    functor: Any
    request: Any
    asked: NDArray[np.int64]
    bit: int
    distance: NDArray[np.float64]
    normal: NDArray[np.float64]
    point: NDArray[np.float64] | None = None
    first: NDArray[np.float64] | None = None
    second: NDArray[np.float64] | None = None
    turned: int = NOT_TURNED
    turn: NDArray[np.float64] | None = None
    plane: Any = None
    shapes: tuple[Any, ...] = ()


class Evaluator:
    """Object of the shim for one run, with the Python objects whose addresses it stores.

    Attributes:
        address: Address of the object.
    """

    def __init__(self, library: Any, address: int, references: Sequence[Any]) -> None:
        """Free the object with this one."""
        self.address, self._library, self._references = address, library, references
        weakref.finalize(self, library.apin_free, address)

    @property
    def error(self) -> str:
        """Text of the last exception in machine code; empty without any."""
        return str(self._library.apin_error(self.address).decode("utf-8", "replace"))


class NativeShim:
    """Functions of the loaded shim.

    Attributes:
        acceleration: Address of the forward dynamics of a tree.
        terms: Address of mass matrix and bias of a tree.
        distances: Address of the distances of pairs of shapes.
        fail: Address of a function that raises inside.
        versions: Versions that it was compiled against.
    """

    def __init__(self, library: Any, versions: dict[str, Any]) -> None:
        """Declare the functions."""
        self._library, self.versions = library, versions
        pointer, whole = ctypes.c_void_p, ctypes.c_int64
        for name, result, arguments in (
            ("apin_tree", pointer, [pointer, pointer]),
            ("apin_tree_sizes", None, [pointer, pointer, pointer, pointer]),
            ("apin_pairs", pointer, [pointer, whole]),
            ("apin_error", ctypes.c_char_p, [pointer]),
            ("apin_free", None, [pointer]),
        ):
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
        self.acceleration, self.terms, self.distances, self.fail = (
            _address_of(getattr(library, f"apin_{name}"))
            for name in ("acceleration", "terms", "distances", "fail")
        )

    def tree(
        self,
        model: Any,
        state: NDArray[np.float64],
        effort: NDArray[np.float64],
        acceleration: NDArray[np.float64],
        mass: NDArray[np.float64],
        bias: NDArray[np.float64],
    ) -> Evaluator | None:
        """Return an evaluator of a tree's dynamics; None if the model's address cannot be had.

        Args:
            model: ``pinocchio.Model``.
            state: [q, v, ...], read.
            effort: Generalized force, (nv,), read.
            acceleration: Generalized, (nv,), written.
            mass: Mass matrix, (nv, nv), written.
            bias: Bias forces, (nv,), written.
        """
        address = _address_in_bindings(model, _MODEL)
        if address is None:
            return None
        arrays = (state, effort, acceleration, mass, bias)
        made = self._library.apin_tree(address, ctypes.byref(_TreeArrays(*map(_place_of, arrays))))
        if not made:
            return None
        evaluator = Evaluator(self._library, made, (model, *arrays))
        nq, nv, gravity = ctypes.c_int64(), ctypes.c_int64(), np.zeros(6)
        self._library.apin_tree_sizes(made, ctypes.byref(nq), ctypes.byref(nv), _place_of(gravity))
        same = (nq.value, nv.value) == (model.nq, model.nv) and (gravity == model.gravity.vector).all()
        return evaluator if same else None

    def pairs(self, pairs: Sequence[ShapePair]) -> Evaluator | None:
        """Return an evaluator of pairs of shapes; None if an address cannot be had."""
        given = (_PairAddresses * len(pairs))()
        for place, pair in zip(given, pairs, strict=True):
            functor = _address_in_bindings(pair.functor, _FUNCTOR)
            request = _address_in_bindings(pair.request, _REQUEST)
            plane = None if pair.plane is None else _address_in_bindings(pair.plane, _HALFSPACE)
            if functor is None or request is None or (plane is None) != (pair.plane is None):
                return None
            place.functor, place.request, place.plane = functor, request, plane
            place.turned, place.bit = pair.turned, pair.bit
            for name in ("asked", "first", "second", "turn", "distance", "normal", "point"):
                array = getattr(pair, name)
                setattr(place, name, None if array is None else _place_of(array))
        made = self._library.apin_pairs(ctypes.byref(given), len(pairs))
        return Evaluator(self._library, made, list(pairs)) if made else None

    def evaluate(self, address: int, evaluator: Evaluator) -> int:
        """Call a function of an evaluator by its address; return its status."""
        return call_back(address, 0.0, evaluator.address)


def _place_of(array: NDArray[Any]) -> int:
    """Return where a contiguous array stands."""
    assert array.flags.c_contiguous
    return int(array.ctypes.data)


def _address_of(function: Any) -> int:
    """Return the address of a function of C."""
    found = ctypes.cast(function, ctypes.c_void_p).value
    assert found is not None
    return found


# --- addresses of C++ objects in the bindings ---------------------------------------------------------------


@functools.cache
def _bindings() -> Any:
    """Return Boost.Python as the bindings have loaded it; None if it is not there."""
    prefix = prefix_of("cmeel-boost")
    pattern = f"libboost_python{sys.version_info[0]}{sys.version_info[1]}.so.*"
    for path in [] if prefix is None else sorted((prefix / "lib").glob(pattern)):
        with contextlib.suppress(OSError, AttributeError):
            # By its name, and only if loaded: a second copy would have other type tables.
            boost = ctypes.PyDLL(path.name, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
            query = boost._ZN5boost6python9converter8registry5queryENS0_9type_infoE
            query.restype, query.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
            get = boost._ZN5boost6python9converter22get_lvalue_from_pythonEP7_objectRKNS1_12registrationE
            get.restype, get.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_void_p]
            return boost
    return None


def _address_in_bindings(value: Any, name: bytes) -> int | None:
    """Return the address of the C++ object in a Python object; None without one."""
    boost = _bindings()
    if boost is None:
        return None
    known = boost._ZN5boost6python9converter8registry5queryENS0_9type_infoE(name)
    if not known:
        return None
    found: int | None = (
        boost._ZN5boost6python9converter22get_lvalue_from_pythonEP7_objectRKNS1_12registrationE(value, known)
    )
    return found


# --- loading ------------------------------------------------------------------------------------------------


class _NotUsedError(Exception):
    """Reason why the shim is not used."""


def native_shim() -> NativeShim | None:
    """Return the shim; None where Python is used instead.

    Raises:
        InvalidParameterError: ``ANTENNA_PIN_NATIVE`` is neither ``off`` nor ``required`` nor empty.
        MissingToolError: It is ``required``, and cannot be used.
    """
    wanted = _wanted()
    if wanted == "off":
        return None
    shim, reason = _loaded()
    if shim is None and wanted == "required":
        raise MissingToolError(
            f"{_VARIABLE}=required: the shim to Pinocchio and coal must be usable, but {reason}; build it by "
            f"python -m antenna_pin.compiled.native_build, or leave {_VARIABLE} out"
        )
    return shim


def native_state() -> str:
    """Return in words whether the shim is used, and why not."""
    if _wanted() == "off":
        return f"not used: {_VARIABLE}=off"
    shim, reason = _loaded()
    if shim is None:
        return f"not used: {reason}"
    told = shim.versions
    return f"of pin {told['pin']}, coal {told['coal']}, Eigen {told['eigen']}"


def _wanted() -> str:
    wanted = os.environ.get(_VARIABLE, "")
    if wanted not in ("", "off", "required"):
        raise InvalidParameterError("environment", _VARIABLE, "off, required or empty", wanted)
    return wanted


@functools.cache
def _loaded() -> tuple[NativeShim | None, str]:
    """Return the shim, or the reason why it is not used."""
    try:
        return _load(FOLDER / NAME), ""
    except _NotUsedError as error:
        return None, str(error)


def _load(path: Path) -> NativeShim:
    """Return the shim in a file, checked.

    Raises:
        _NotUsedError: It is missing, or was compiled for other versions.
    """
    versions = _versions_in(path)
    owner = os.stat(__file__).st_uid
    stranger = stranger_of(path.parent, owner) or open_to(path.stat(), owner)
    if stranger:
        raise _NotUsedError(f"{path} is not safe, for {stranger}")
    prefix = prefix_of("libpinocchio")
    try:
        import eigenpy

        own = eigenpy.SimdInstructionSetsInUse()
        if prefix is not None:  # by their own names, so that each is loaded once
            for name in ("libpinocchio_default.so", "libcoal.so"):
                ctypes.CDLL(str(prefix / "lib" / name))
        library = ctypes.CDLL(str(path), mode=os.RTLD_NOW)
        told = library.apin_instruction_set
    except (ImportError, OSError, AttributeError) as error:
        raise _NotUsedError(f"{path.name} cannot be loaded: {error}") from None
    told.restype = ctypes.c_char_p
    if told().decode() != own:
        raise _NotUsedError(f"{path.name} uses {told().decode()}, the bindings {own}")
    return NativeShim(library, versions)


def _versions_in(path: Path) -> dict[str, Any]:
    """Return the versions that a shim was compiled against, which are those installed."""
    try:
        told = built_of(path)
    except FileNotFoundError:
        raise _NotUsedError("it is not built (python -m antenna_pin.compiled.native_build)") from None
    except (OSError, ValueError) as error:
        raise _NotUsedError(f"{path.name} cannot be read: {error}") from None
    again = "rebuild it by python -m antenna_pin.compiled.native_build"
    if told.get("interface") != _INTERFACE or told.get("source") != digest_of_sources():
        raise _NotUsedError(f"{path.name} was built of other sources; {again}")
    for package, name in (("pin", "pin"), ("coal", "coal")):
        try:
            installed = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            installed = "not a package"
        if told.get(name) != installed:
            raise _NotUsedError(
                f"{path.name} was built for {package} {told.get(name)}, installed is {installed}; {again}"
            )
    return told
