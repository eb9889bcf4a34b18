"""The three figures of the page without a browser: curves of a run, of the one compared with, and of none."""

import numpy as np
import pytest

from antenna_pin.apps.live.explored import Curve, Curves

panels = pytest.importorskip("antenna_pin.apps.live.page", reason="the extra explore is not installed")


def curves(size=1.0, names=("end +", "radial", "acceleration, hinge")):
    """Circles as a path and ramps over time, as large as is said."""
    turn = np.linspace(0.0, 2.0 * np.pi, 50)
    path = Curve(names[0], 2e-4 * size * np.cos(turn), 2e-4 * size * np.sin(turn), "m")
    force, acceleration = Curve(names[1], turn, size * turn, "N"), Curve(names[2], turn, -turn, "rad/s^2")
    ring = 3e-4 * np.column_stack([np.cos(turn[:-1]), np.sin(turn[:-1])])
    return Curves((path,), (force,), (acceleration,), ring)


def shown(page):
    """Return x and y of each line that has points, by the name of its source."""
    found = {}
    for column in page.columns:
        for renderer in column.children[0].renderers:
            data = renderer.data_source.data
            if len(data["x"]):
                found[renderer.data_source.name] = np.array([data["x"], data["y"]])
    return found


def expected(said, before):
    """Return what is shown: a path in millimetres, its outline closed, all else as it is."""
    found = {}
    for when, one in (("now", said), ("before", before)):
        every = () if one is None else (*one.first, *one.second, *one.third)
        for curve in every:
            factor = 1e3 if curve.unit == "m" else 1.0
            found[f"{when} {curve.name}"] = factor * np.array([curve.x, curve.y])
    return found


def check(page, said, before):
    found, wanted = shown(page), expected(said, before)
    outline = found.pop("outline")
    assert found.keys() == wanted.keys()
    for name, values in wanted.items():
        np.testing.assert_allclose(found[name], values, rtol=1e-15)
    np.testing.assert_allclose(outline[:, :-1], 1e3 * said.outline.T, rtol=1e-15)
    assert np.array_equal(outline[:, -1], outline[:, 0])


def test_a_run_is_shown_beside_the_one_it_is_compared_with():
    """Also where figures are made anew, for a joint that has the same curves, or others."""
    page = panels.Panels()
    first, second, third = curves(), curves(2.0), curves(0.5)
    page.show(first, None)
    check(page, first, None)
    page.show(second, first)
    check(page, second, first)
    page.show(third, first)
    check(page, third, first)
    page.forget()
    page.show(second, first)
    check(page, second, first)
    page.show(third, second)
    check(page, third, second)
    page.show(third, None)
    check(page, third, None)


def test_curves_of_another_kind_are_compared_with_nothing():
    page = panels.Panels()
    other = curves(names=("centre", "radial", "acceleration, elbow"))
    page.show(other, None)
    more = Curves(other.first * 2, other.second, other.third, other.outline)
    page.show(other, more)
    check(page, other, None)
