"""Flexible links against a floating frame with assumed modes: what masses on springs keep and leave out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from floating_frame import Cantilever, cantilever, deflections, frequencies

from antenna_pin import load_scenario, simulate
from antenna_pin.studies.linear import modes

TAU = 2.0 * np.pi
MASS, LENGTH, FIRST = 4.0, 2.0, TAU * 2.0

URDF = """<robot name="arm"><link name="world_frame"/><link name="beam"><inertial><origin xyz="1 0 0"/>
<mass value="4"/>
<inertia ixx="0.01" iyy="1.3433333333333333" izz="1.3433333333333333" ixy="0" ixz="0" iyz="0"/>
</inertial></link><joint name="turn" type="continuous"><parent link="world_frame"/><child link="beam"/>
<axis xyz="0 0 1"/></joint></robot>"""
SCENARIO = """format = 1
duration = {duration}
[mechanism]
urdf = "arm.urdf"
base = "fixed"
[drives.turn]
kind = "motion"
{motion}
[integrator]
rtol = 1e-11
[flexible.beam]
{flexible}
"""


def arm(folder: Path, beam: Cantilever, motion: str, duration: float = 1.0, kind: str = "modes") -> Any:
    """The beam with its modes as masses on slides, or by its modal data, on a hub that turns as told."""
    rows = list(zip(beam.omega / TAU, beam.translation, beam.rotation, strict=True))
    if kind == "modes":
        flexible = 'kind = "modes"\n' + "".join(
            f"[flexible.beam.modes.m{k}]\nfrequency = {float(f)!r}\nmass = {float(t**2)!r}\n"
            f"direction = [0, 1, 0]\nplace = [{float(r / t)!r}, 0, 0]\n"
            for k, (f, t, r) in enumerate(rows)
        )
    else:
        factors = [float(x) for _, t, r in rows for x in (0, t, 0, 0, 0, r)]
        flexible = (
            f'kind = "modal-data"\nfrequency = {[float(row[0]) for row in rows]}\nparticipation = {factors}\n'
        )
    (folder / "arm.urdf").write_text(URDF)
    (folder / "arm.toml").write_text(SCENARIO.format(duration=duration, motion=motion, flexible=flexible))
    return load_scenario(folder / "arm.toml")


def test_a_known_beam():
    """Tabulated: delta of the first mode 0.783 of sqrt(m), and G_11 = 1.193 of Southwell's formula."""
    beam = cantilever(MASS, LENGTH, FIRST, 3)
    assert beam.translation[0] / np.sqrt(MASS) == pytest.approx(0.7830, abs=1e-4)
    assert beam.rotation[0] / (np.sqrt(MASS) * LENGTH) == pytest.approx(0.5688, abs=1e-4)
    assert beam.omega[1] / beam.omega[0] == pytest.approx(6.2669, abs=1e-4)
    assert beam.stiffening[0, 0] == pytest.approx(1.1933, abs=1e-4)


@pytest.mark.parametrize("count", [1, 2])
def test_spinning_up(tmp_path: Path, count: int):
    """To a third of the first frequency: the floating frame without stiffening, to the integrator's error.

    With it the beam lags by less: what a mass on a spring leaves out.
    """
    beam = cantilever(MASS, LENGTH, FIRST, count)
    last, span = FIRST / 3.0, 3.0
    swing = last / span * (span / TAU) ** 2
    motion = (
        f"position = {-swing!r}\ncoefficients = [{0.5 * last / span!r}]\n"
        f"amplitude = {swing!r}\nfrequency = {1.0 / span!r}\nphase = {0.5 * np.pi!r}"
    )
    run = simulate(arm(tmp_path, beam, motion, span))
    times = np.unique(np.linspace(0.0, span, 61).round(6))
    every = run.data["time"].values
    at = np.searchsorted(every, times - 1e-9)

    def spin(t: float) -> float:
        return last / span * (t - span / TAU * np.sin(TAU * t / span))

    def rate(t: float) -> float:
        return last / span * (1.0 - np.cos(TAU * t / span))

    soft, stiff = (deflections(beam, spin, rate, every[at], stiffened) for stiffened in (False, True))
    system = modes(arm(tmp_path, beam, motion, span)).linearisation.system
    for k in range(count):
        slot = system.mechanism.joint(f"beam_m{k}")
        # A mass m on a slide has the modal coordinate sqrt(m) times its way, of either sign.
        own = run.data["q"].values[at, slot.q.start]
        body = system.model.inertias[slot.joint_id]
        eta = np.sqrt(body.mass) * own
        eta *= np.sign(eta @ soft[:, k])
        assert np.abs(eta - soft[:, k]).max() < 1e-8 * np.abs(soft[:, k]).max()
    apart = np.abs(soft[:, 0] - stiff[:, 0]).max() / np.abs(stiff[:, 0]).max()
    # Of stiffness G Omega^2 / omega^2 = 1.19 / 9 at the end, where the torque has gone: less while it acts.
    assert apart == pytest.approx(0.073, abs=0.001)


@pytest.mark.parametrize("share", [0.1, 0.9, 1.1])
def test_frequency_over_spin(tmp_path: Path, share: float):
    """omega^2 - Omega^2 of the mass on its spring, omega^2 + 0.19 Omega^2 of the beam."""
    beam = cantilever(MASS, LENGTH, FIRST, 1)
    found = modes(arm(tmp_path, beam, f"rate = {share * FIRST!r}"), moving=True)
    soft = frequencies(beam, share * FIRST, False)[0]
    stiff = frequencies(beam, share * FIRST, True)[0]
    if share < 1.0:
        assert found.frequency * TAU == pytest.approx([np.sqrt(soft)], rel=1e-8)
    else:
        assert list(found.data["kind"].values) == ["unstable"]
        assert found.data["root_real"].values.max() == pytest.approx(np.sqrt(-soft), rel=1e-8)
    assert np.sqrt(stiff) / FIRST == pytest.approx(np.sqrt(1.0 + 0.1933 * share**2), rel=1e-4)


def test_a_mode_on_a_hinge_softens_less(tmp_path: Path):
    """Modal data of a beam become an unbalanced body on a hinge: exact to first order, no beam beyond it."""
    beam = cantilever(MASS, LENGTH, FIRST, 1)
    found = modes(arm(tmp_path, beam, f"rate = {0.3 * FIRST!r}", kind="modal-data"), moving=True)
    change = ((TAU * found.frequency[0] / FIRST) ** 2 - 1.0) / 0.3**2
    assert change == pytest.approx(-0.2326, abs=1e-3)
