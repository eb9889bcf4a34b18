"""Dimensions of joints with play in scenarios: keys and checks from the shapes' classes.

A table has the keys of all shapes: those of others than its own wait for another case.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Annotated, Any, NamedTuple

from pydantic import SerializerFunctionWrapHandler, create_model, model_serializer, model_validator

from antenna_pin.base.iso_fits import IsoFit, read_fit
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimensions_of
from antenna_pin.joints.geometry.registry import MODELS, SHAPES
from antenna_pin.scenario._class_tables import annotated
from antenna_pin.scenario.spec import QuantityRule, Spec, read_quantity, refuse

# --- keys ---------------------------------------------------------------------------------------------------

FIT = ("fit", "fit_hole", "fit_shaft")
"""Keys of a fit."""

# What a fit decides.
_OF_FIT = (RADIAL.outer, RADIAL.key, RADIAL.inner)


class Fit(Spec):
    """Keys of a fit.

    Attributes:
        fit: Fit of hole and shaft by ISO 286, as ``"20 H7/g6"`` with the diameter in millimetres, instead of
            the radii; sizes are in the middle of their zones unless the next two say otherwise.
        fit_hole: Place of the hole's size in its zone, from -1 at the lower limit to 1 at the upper one [-].
        fit_shaft: Likewise of the shaft [-].
    """

    fit: str | None = None
    fit_hole: Annotated[float, QuantityRule("1")] = 0.0
    fit_shaft: Annotated[float, QuantityRule("1")] = 0.0

    @model_validator(mode="before")
    @classmethod
    def _read_fit(cls, data: Any) -> Any:
        """Complete the radii by the fit, or refuse one beside radii or without play."""
        return _with_fit(data, getattr(cls, "shape_class", None)) if isinstance(data, Mapping) else data

    @model_serializer(mode="wrap")
    def _as_in_files(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return the table without what follows from the fit."""
        found: dict[str, Any] = handler(self)
        of_fit = _OF_FIT if self.fit is not None else FIT
        return {key: value for key, value in found.items() if key not in of_fit}

    @property
    def limits_of_fit(self) -> IsoFit | None:
        """The fit, with the limits of hole and shaft; None without one."""
        return None if self.fit is None else read_fit(self.fit)


class _Key(NamedTuple):
    """Key of a shape's table."""

    name: str
    kind: Any  # annotation
    doc: str
    required: bool


def _keys_of(shape: type[Any]) -> Iterator[_Key]:
    """Yield the keys of a shape's dimensions, each behind the play that may decide it."""
    parameters, dimensions = parameters_of(shape), dimensions_of(shape)
    seen = set()
    for name, one in dimensions.items():
        parameter, required = parameters[name], parameters[name].required
        doc = parameter.doc.removesuffix(".")
        for play in shape.plays:
            if play.decides == name and play.key:
                required, doc = False, f"{doc}; or give ``{play.key}``"
                if play.key not in seen:
                    seen.add(play.key)
                    yield _Key(play.key, Annotated[float, QuantityRule("m", play.rule)], play.doc, False)
        if one.times is not None:
            factor, other = one.times
            times = "" if factor == 1.0 else f"{factor:g} "
            required, doc = False, f"{doc}; {times}``{dimensions[other].key}`` is assumed"
        yield _Key(one.key, annotated(parameter, float), f"{doc}.", required)


@cache
def dimension_keys() -> type[Spec]:
    """Return the keys of the dimensions of all shapes, none of them required."""
    found: dict[str, _Key] = {}
    for shape in SHAPES.values():
        for key in _keys_of(shape):
            found.setdefault(key.name, key)
    doc = _doc("Dimensions of joints with play.", found.values())
    fields: dict[str, Any] = {key.name: (key.kind | None, None) for key in found.values()}
    return create_model("DimensionKeys", __base__=Fit, __doc__=doc, __module__=__name__, **fields)


def _doc(text: str, keys: Iterable[_Key]) -> str:
    """Return the docstring of a table."""
    lines = "".join(f"        {key.name}: {key.doc}\n" for key in keys)
    return f"{text}\n\n    Attributes:\n{lines}    "


def table_of(name: str, base: type[Any], model: Any, shape: type[Any] | None = None) -> Any:
    """Return the table of a model of a joint.

    It has the keys of dimensions, those of its base, and ``model``.

    Args:
        name: Name of the class, by which its base's module finds it.
        base: Its base; without a shape also its description.
        model: Type of the key ``model``.
        shape: Class of its shape, whose summary is its description.
    """
    keys = [] if shape is None else [*_keys_of(shape)]
    fields: dict[str, Any] = {"model": (model, ...)}
    fields |= {key.name: (key.kind, ...) for key in keys if key.required}
    doc = base.__doc__ if shape is None else _doc((shape.__doc__ or "").partition("\n\n")[0], keys)
    bases, module = (base, dimension_keys()), base.__module__
    table: Any = create_model(name, __base__=bases, __doc__=doc, __module__=module, **fields)
    if shape is not None:
        table.shape_class = shape
    return table


@cache
def alternatives(model: str) -> tuple[tuple[frozenset[str], frozenset[str]], ...]:
    """Return keys of a model's table that exclude each other.

    Dimensions of other shapes exclude no play of the model's own: they wait for another case.
    """
    own = [SHAPES[MODELS[model]]] if model in MODELS else []
    found: dict[str, frozenset[str]] = {}
    for shape in (*own, *SHAPES.values()):
        for key, names in by_key(shape).items():
            found.setdefault(key, frozenset(names))
    plays = ((frozenset({key}), names) for key, names in found.items())
    return (*plays, (frozenset(FIT), frozenset(_OF_FIT)))


def by_key(shape: type[Any]) -> dict[str, list[str]]:
    """Return the keys of dimensions that plays of a shape decide, by the play's key."""
    found: dict[str, list[str]] = {}
    for play in shape.plays:
        if play.key:
            found.setdefault(play.key, []).append(dimensions_of(shape)[play.decides].key)
    return found


# --- values -------------------------------------------------------------------------------------------------


class Sizes(NamedTuple):
    """Dimensions of a joint's shape, as a table gives them."""

    sizes: dict[str, float]  # by the names of its class [m], [rad]
    plays: dict[str, float]  # by their keys [m]
    assumed: dict[str, tuple[float, str]]  # values [m] by key, with what they are in words


def check_plays(table: Any) -> None:
    """Refuse a play given twice or not at all."""
    for key, names in by_key(table.shape_class).items():
        given = [name for name in names if getattr(table, name) is not None]
        is_given, like = getattr(table, key) is not None, _play(table.shape_class, key).like
        if is_given != bool(given) and given in ([], names) or not is_given and not given and like:
            continue
        both = f"{key}{',' if len(names) > 1 else ''} and {' with '.join(names)}"
        got = "both" if is_given else f"{given[0]} alone" if given else "neither"
        refuse(f"must have exactly one of {both}, got {got}")


def solved(table: Any) -> Sizes:
    """Return the dimensions of a table's shape, given, decided by a play, or assumed."""
    shape = table.shape_class
    parameters = parameters_of(shape)
    sizes: dict[str, float] = {}
    plays: dict[str, float] = {}
    assumed: dict[str, tuple[float, str]] = {}
    for name, one in dimensions_of(shape).items():
        value = getattr(table, one.key)
        for play in shape.plays:
            if play.decides != name or not play.key:
                continue
            clearance = getattr(table, play.key)
            if clearance is None and value is None:
                clearance = plays[play.like]
                words = f"{play.words} {{}} as the {_play(shape, play.like).words.removesuffix(' play')}"
                assumed[play.key] = clearance, words
            if value is None:
                value = play.decided(sizes, clearance)
            own = play.of({**sizes, name: value}) if clearance is None else clearance
            plays[play.key] = min(own, plays.get(play.key, own))
        if value is None and one.times is not None:
            value = one.times[0] * sizes[one.times[1]]
            assumed[one.key] = value, f"{one.words} {{}}"
        sizes[name] = parameters[name].default if value is None else value
    return Sizes(sizes, plays, assumed)


def _play(shape: type[Any], key: str) -> Play:
    found: Play = next(play for play in shape.plays if play.key == key)
    return found


def refuse_shape(table: Any, error: InvalidParameterError) -> None:
    """Refuse what a shape's class refuses, by the key that gave it."""
    shape = table.shape_class
    dimensions = dimensions_of(shape)
    rule, size = error.rule, solved(table).sizes[error.parameter]
    for name, one in dimensions.items():
        rule = rule.replace(name, one.key)
    key = dimensions[error.parameter].key
    for play in shape.plays:
        value = getattr(table, play.key) if play.key and play.decides == error.parameter else None
        if value is not None:
            text = f"must make {key} {rule}, got {value:g} m, which makes it {size:g} m"
            refuse(text, play.key, value=value)
    refuse(f"must be {rule}, got {size:g} {parameters_of(shape)[error.parameter].unit}", key, value=size)


def _with_fit(data: Mapping[str, Any], shape: type[Any] | None) -> dict[str, Any]:
    """Return the table of a joint with the radii that its fit decides."""
    text, done = data.get("fit"), dict(data)
    positions = {key: data[key] for key in ("fit_hole", "fit_shaft") if data.get(key) is not None}
    if text is None:
        for key, value in positions.items():
            if read_quantity(value, "1", "", key) != 0.0:
                refuse("must be left out without fit, in whose zone it is a place", key, value=value)
        return done
    if not isinstance(text, str):
        refuse(f"must be text, got {shown(text)}", "fit", value=text)
    decided = () if shape is None else [name for names in by_key(shape).values() for name in names]
    if shape is not None and RADIAL.inner not in decided:
        refuse(
            f"must be left out where no hole and shaft leave the play: give {' and '.join(decided)}",
            "fit",
            value=text,
        )
    for key in _OF_FIT:
        if data.get(key) is not None:
            refuse(f"must be left out with fit = {shown(text)}, which decides it", key, value=data[key])
    try:
        fit = read_fit(text)
    except InvalidParameterError as error:
        refuse(f"must be {error.rule}, got {shown(text)}", "fit", value=text)
    hole, shaft = (read_quantity(positions.get(key, 0.0), "1", "", key) for key in ("fit_hole", "fit_shaft"))
    for key, value in (("fit_hole", hole), ("fit_shaft", shaft)):
        if not -1.0 <= value <= 1.0:
            refuse(f"must be from -1 to 1, the limits of the zone, got {value:g}", key, value=value)
    play = fit.radial_clearance(hole, shaft)
    if not play > 0.0:
        most = f"{1e6 * fit.largest:.3g} um at most" if fit.largest > 0.0 else "none at any size"
        refuse(
            f"must leave play, got {shown(text)} with a radial clearance of {1e6 * play:.3g} um at these "
            f"sizes, {most}; take a fit with play, or fit_hole and fit_shaft",
            "fit",
            value=text,
        )
    return done | {RADIAL.outer: 0.5 * fit.hole.size(hole), RADIAL.inner: 0.5 * fit.shaft.size(shaft)}
