"""Names of a result's joints and contacts, and presence of series."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from antenna_pin.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

#: The kind of contact at a flange; all others are those of a bore, a socket or a guide.
_FLANGE = "axial"


def is_lean(data: xr.Dataset) -> bool:
    """Return whether a result was recorded without its series."""
    return data.attrs.get("form") == "lean"


def series(data: xr.Dataset, place: str) -> xr.Dataset:
    """Return the data of a run with series, or refuse them.

    Args:
        data: Of a run.
        place: Name of the caller, for messages.

    Raises:
        FileFormatError: The result is a lean one.
    """
    if is_lean(data):
        case = str(data.attrs.get("case") or data.attrs.get("title") or "the run")
        raise FileFormatError(
            f"{place}: needs the series of {case}, which its lean result has not; "
            "run it again with output.form = 'full'"
        )
    return data


def json_in(text: object) -> object:
    """Return the content of an attribute that is JSON; None if it is not."""
    try:
        return json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return None


def names_along(data: xr.Dataset, dimension: str) -> list[str]:
    """Return the labels along a dimension or of a coordinate; [] without it."""
    return [str(name) for name in data.variables[dimension].values] if dimension in data.coords else []


def _along_contacts(data: xr.Dataset, name: str) -> dict[str, str]:
    contacts = names_along(data, "contact")
    labels = names_along(data, name)
    if len(labels) != len(contacts):
        raise FileFormatError(f"run: no coordinate {name!r}; is it an antenna_pin result?")
    return dict(zip(contacts, labels, strict=True))


def contact_joints(data: xr.Dataset) -> dict[str, str]:
    """Return the clearance joint of each contact, by the contact's name."""
    return _along_contacts(data, "contact_joint")


def contact_kinds(data: xr.Dataset) -> dict[str, str]:
    """Return the kind of each contact, such as radial or axial, by the contact's name."""
    return _along_contacts(data, "contact_kind")


def contact_ends(data: xr.Dataset) -> dict[str, str]:
    """Return the bearing's end of each contact, "+", "-" or none, by contact."""
    return _along_contacts(data, "contact_end")


def contacts_of(data: xr.Dataset, joint: str, *, flanges: bool | None = None) -> list[str]:
    """Return the contacts of a clearance joint.

    Args:
        data: Of a run.
        joint: The clearance joint.
        flanges: Those at flanges only, or those in the bore (socket, guide) only; all if not given.
    """
    kinds = contact_kinds(data)
    return [
        name
        for name, of in contact_joints(data).items()
        if of == joint and (flanges is None or (kinds[name] == _FLANGE) == flanges)
    ]
