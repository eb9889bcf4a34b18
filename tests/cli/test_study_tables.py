"""What a grid of runs came to, a row each, in units that people read."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.apps.cli.study import grid_rows
from antenna_pin.show.plot.study import cell_edges, is_spaced_by_factors, quantity_of


@pytest.fixture
def grid():
    """A study of a play and a friction, with a response for each pair."""
    table = xr.Dataset(
        {
            "force": (("play", "friction"), [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], {"units": "N"}),
            "outcome": (("play", "friction"), np.full((3, 2), "COMPLETED", dtype=object)),
        },
        coords={
            "play": ("play", [1e-5, 5e-5, 2.5e-4], {"units": "m"}),
            "friction": ("friction", [0.1, 0.2], {"units": "1"}),
        },
    )
    table.attrs = {"parameters": '{"play": 1, "friction": 1}', "responses": '{"force": 1}', "method": "grid"}
    return table


def test_a_grid_has_a_row_for_each_run_with_one_prefix_a_column(grid):
    head, rows, more = grid_rows(grid)
    assert head == ["run", "play [µm]", "friction", "force [N]"] and more == 0
    assert rows[0] == ["0", "10", "0.1", "1"] and rows[-1] == ["5", "250", "0.2", "6"]


def test_outcomes_stand_beside_the_runs_where_one_did_not_end_well(grid):
    grid["outcome"].values[1, 0] = "TOO_DEEP"
    head, rows, _ = grid_rows(grid)
    assert head[-1] == "outcome" and rows[2][-1] == "TOO_DEEP"


@pytest.mark.parametrize(
    ("values", "by_factors"),
    [
        ([1.0, 3.0, 10.0, 30.0], True),
        ([1.0, 2.0, 3.0, 4.0], False),
        ([1.0, 4.0, 7.0, 10.0], False),
        ([0.0, 1.0, 10.0], False),
        ([1.0, 100.0], False),
    ],
)
def test_an_axis_is_logarithmic_where_values_are_spaced_by_factors(values, by_factors):
    assert is_spaced_by_factors(np.array(values)) == by_factors


def test_an_axis_has_the_values_themselves_as_ticks_in_a_unit_that_suits_them(grid):
    play = quantity_of(grid, "play")
    assert play.label == "Play [µm]" and play.ticks == pytest.approx((10.0, 50.0, 250.0)) and play.logarithmic


def test_cells_of_a_map_end_halfway():
    assert cell_edges(np.array([1.0, 2.0, 4.0]), False) == pytest.approx([0.5, 1.5, 3.0, 5.0])
    assert cell_edges(np.array([1.0, 4.0, 16.0]), True) == pytest.approx([0.5, 2.0, 8.0, 32.0])
    assert np.all(np.diff(cell_edges(np.array([3.0]), True)) > 0.0)
