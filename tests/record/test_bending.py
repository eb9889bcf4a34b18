"""Flexible links in recordings: bodies are drawn at so many times their deflection, and it is said."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import lxml.html
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from antenna_pin import AntennaPinError, Trajectory, load_scenario, simulate
from antenna_pin.analysis import body_poses, elastic_parts_of, mechanism_of
from antenna_pin.show.record import bending_magnification, record
from antenna_pin.show.record.bending import drawn_poses
from antenna_pin.show.report import report

FRAMES = np.array([0, 30, 60, 90])


@pytest.fixture(scope="module", params=["flexible-ideal", "petals-ideal"])
def run(request: Any) -> Trajectory:
    return simulate(load_scenario("bai2020", case=request.param), duration=0.1)


def placement(poses: Any, body: str, sample: int) -> np.ndarray:
    found = np.eye(4)
    found[:3, :3] = Rotation.from_quat(poses["attitude"].sel(body=body).values[sample]).as_matrix()
    found[:3, 3] = poses["position"].sel(body=body).values[sample]
    return found


def test_bodies_are_drawn_where_the_twists_of_their_parts_bring_them(run: Trajectory):
    """By the matrix exponential of the sum of all twists that move a shape, in the hub's frame."""
    factor, about, mechanism = 300.0, elastic_parts_of(run), mechanism_of(run)
    poses, true = drawn_poses(run, FRAMES, factor), body_poses(run, FRAMES)
    assert sorted(poses["body"].values) == sorted(true["body"].values)
    moved = 0.0
    for name, one in about.items():
        if any(name in other.get("with", ()) for other in about.values()):
            continue  # its own body has no shape
        for sample, frame in enumerate(FRAMES):
            twist = np.zeros((4, 4))
            for part in (name, *one.get("with", ())):
                axis, origin = mechanism.urdf.axis(part), mechanism.urdf.placement(part)[:3, 3]
                x = factor * float(run.data["deflection"].sel(elastic_part=part).values[frame])
                if about[part]["slides"]:
                    twist[:3, 3] += x * axis
                else:
                    twist[:3, :3] += x * np.cross(axis, np.eye(3)).T
                    twist[:3, 3] -= x * np.cross(axis, origin)
            rest = mechanism.urdf.placement(name)
            expected = placement(true, one["hub"], sample) @ expm(twist) @ rest
            assert np.abs(placement(poses, one["body"], sample) - expected).max() < 1e-12
            moved = max(moved, float(np.abs(expm(twist) - np.eye(4)).max()))
    assert moved > 0.05  # something was to be seen
    for body in ("body", "shaft1", "shaft2", "reflector"):
        assert (poses["position"].sel(body=body).values == true["position"].sel(body=body).values).all()


def test_the_screen_says_what_is_magnified(run: Trajectory):
    said = "deflections of flexible links are drawn 300 times as large"
    assert said in [fact["text"] for fact in record(run, magnify=300.0).data["facts"]]
    assert not [fact for fact in record(run).data["facts"] if "deflection" in fact["text"]]


def test_reports_choose_a_magnification_that_shows_the_bending(run: Trajectory):
    chosen = bending_magnification(run)
    assert chosen is not None
    assert chosen > 1.0
    page = lxml.html.fromstring(report([run], figures=False).html)
    packed = page.xpath("//script[@type='application/zlib']/text()")
    texts = [zlib.decompress(base64.b64decode(one)).decode(errors="ignore") for one in packed]
    assert any(f"drawn {chosen:g} times as large" in text for text in texts)


@pytest.mark.parametrize("magnify", [-1.0, 0.0, float("nan")])
def test_a_magnification_is_a_positive_number(run: Trajectory, magnify: float):
    with pytest.raises(AntennaPinError, match="magnify must be a positive number"):
        record(run, magnify=magnify)


def test_nothing_of_a_rigid_mechanism_is_magnified():
    rigid = simulate(load_scenario("bai2020", case="case1"), duration=0.01)
    assert bending_magnification(rigid) is None
    with pytest.raises(AntennaPinError, match="without flexible links"):
        record(rigid, magnify=100.0)
