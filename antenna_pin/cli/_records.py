"""Rows of tables of results in plain numbers, as JSON and CSV have them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["plain_number", "records"]


def records(table: xr.Dataset, dim: str) -> list[dict[str, Any]]:
    """Return the rows of a table in plain numbers; None where there is none."""
    return [
        {"of": str(name)}
        | {
            str(column): plain_number(table[column].values[k])
            if table[column].ndim == 1
            else {
                f"{p:g}": plain_number(x)
                for p, x in zip(table["percent"].values, table[column].values[k], strict=True)
            }
            for column in table.data_vars
        }
        for k, name in enumerate(table[dim].values)
    ]


def plain_number(value: Any) -> float | int | None:
    return None if math.isnan(value) else value.item() if hasattr(value, "item") else value
