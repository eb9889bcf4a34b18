"""``antenna-pin orbit`` and ``lyapunov``: what they print, save and draw, and what they refuse."""

import contextlib
import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from antenna_pin import load_scenario, simulate
from antenna_pin.studies.nonlinear import open_branch, open_exponents, open_orbit

DRIVE = "drives.motor={joint='hinge', kind='sine', amplitude='1 N*m', frequency='0.625 Hz'}"
PENDULUM = ("pendulum", "--case", "ideal", "--set", DRIVE)
OVER = ("--over", "drives.motor.amplitude", "--values")


def test_an_orbit_is_told(cli):
    """The damped pendulum comes to the period of its drive; by one count of multipliers and exponents."""
    said = cli("orbit", *PENDULUM, "--json")
    found = json.loads(said.out)
    assert said.code == 0 and found["stable"] and found["residual"] < 1e-9
    assert found["period"] == pytest.approx(1.6) and len(found["multipliers"]) == 2
    told = cli("orbit", *PENDULUM)
    assert told.out.startswith("orbit of 1.6 s, stable") and f"{found['exponents'][0]:.4g}" in told.out


@pytest.mark.slow
def test_a_saved_orbit_and_a_saved_branch_are_gone_on_from(cli, refused):
    """The same orbit without a transient, from its own file; a branch's table again; its orbits by number."""
    first = json.loads(cli("orbit", *PENDULUM, "--out", "orbit.nc", "--json").out)
    again = json.loads(cli("orbit", "orbit.nc", "--json").out)
    np.testing.assert_allclose(again["q"], first["q"], atol=1e-9)
    assert again["period"] == first["period"]
    follow = cli("orbit", "orbit.nc", *OVER, "1 N*m:1.2 N*m", "--out", "branch.nc")
    told = cli("orbit", "branch.nc")
    assert (told.code, told.out) == (0, follow.out.partition("\n")[2])
    other = json.loads(
        cli("orbit", "branch.nc", "--at", "1", "--set", "drives.motor.amplitude=1", "--json").out
    )
    np.testing.assert_allclose(other["q"], first["q"], atol=1e-9)
    for given, said in (
        (("branch.nc", "--at", "0"), "--at must be from 1 to "),
        (("orbit.nc", "--at", "1"), "is one orbit; --at is of branches"),
        (("orbit.nc", "--case", "ideal"), "--case must be left out: the file holds its scenario"),
        ((*PENDULUM, "--at", "1"), "--at must be given with a saved branch"),
        (("nothing.nc",), "nothing.nc: no such file"),
    ):
        assert said in refused(cli("orbit", *given))


def test_exponents_are_told_with_their_error(cli, tmp_path):
    table = tmp_path / "exponents.csv"
    said = cli("lyapunov", *PENDULUM, "--interval", "0.2 s", "--count", "40", "--csv", str(table))
    assert said.code == 0 and table.read_text().startswith("exponent [1/s],error [1/s]\n-")
    short = cli("lyapunov", *PENDULUM, "--interval", "0.2 s", "--count", "4")
    assert short.out.startswith("too short to decide, over 4 intervals")


def test_orbits_and_exponents_are_saved_and_drawn(cli, tmp_path):
    """The file has the numbers that --json tells, its scenario's name, and the command."""
    said = cli("orbit", *PENDULUM, "--out", "orbit.nc", "--plot", "orbit.svg", "--json")
    facts, kept = json.loads(said.out), open_orbit("orbit.nc")
    assert [one for one, _ in facts["multipliers"]] == kept["multiplier_real"].values.tolist()
    assert kept["v"].values.tolist() == facts["v"] and kept.attrs["name"] == "pendulum"
    assert kept.attrs["command"].startswith("antenna-pin orbit pendulum --case ideal --set ")
    files = ("--out", "e.nc", "--plot", "e.png")
    said = cli("lyapunov", *PENDULUM, "--interval", "0.2 s", "--count", "40", *files)
    assert said.out.startswith("saved e.nc\nsaved e.png\ncontracting")
    assert f" {open_exponents('e.nc')['value'].values[0]:.4g} " in said.out
    assert (tmp_path / "e.png").stat().st_size > 5000
    assert (tmp_path / "orbit.svg").read_text().startswith("<?xml")


def symmetry_breaks(low, high):
    """Return the amplitude at which a swing of the pendulum with phi(t + T/2) = -phi(t) loses its stability.

    Of half a period, turned over, it is a fixed point, of which a multiplier passes -1.
    """
    inertia, weight, half = 0.0251004 + 1.872 * 0.2**2, 1.872 * 9.80665 * 0.2, 0.8
    guess = [np.array([-1.0, -8.0])]  # the swing found last, from which the next is not far

    def rates(t, y, torque):
        pull = (torque * np.sin(np.pi * t / half) - 1.2 * y[1] - weight * np.sin(y[0])) / inertia
        jacobian = np.array([[0.0, 1.0], [-weight * np.cos(y[0]) / inertia, -1.2 / inertia]])
        return np.concatenate([[y[1], pull], (jacobian @ y[2:].reshape(2, 2)).ravel()])

    def of_half(torque):
        start = guess[0]
        for _ in range(40):
            y = np.concatenate([start, np.eye(2).ravel()])
            end = -solve_ivp(rates, (0.0, half), y, "DOP853", rtol=1e-12, atol=1e-12, args=(torque,)).y[:, -1]
            step = np.linalg.solve(end[2:].reshape(2, 2) - np.eye(2), start - end[:2])
            start = start + step
            if np.abs(step).max() < 1e-11:
                break
        guess[0] = start
        return np.linalg.det(end[2:].reshape(2, 2) + np.eye(2))

    return brentq(of_half, low, high, xtol=1e-10)


@pytest.mark.slow
def test_an_orbit_is_followed_over_a_key(cli):
    """The pendulum's symmetric swing loses its stability where another branch crosses, by scipy's runs."""
    over = ("--over", "drives.motor.amplitude", "--values", "11 N*m:13 N*m", "--arc", "0.5")
    files = ("--out", "branch.nc", "--plot", "b.svg")
    said = cli("orbit", *PENDULUM, *over, "-q", "motion_angle[hinge]", *files)
    kept = open_branch("branch.nc")
    assert f"{kept.sizes['point']} orbits: it came to the end of the range" in said.out
    assert kept["value"].values[[0, -1]].tolist() == [11.0, 13.0] and kept["value"].attrs["units"] == "N*m"
    assert kept["stability"].values[0] == "stable" and kept["stability"].values[-1] == "unstable"
    assert kept["kind"].values.tolist() == ["branch-point"]
    # Both by runs at 1e-12; what multipliers are wrong by is 1e-9, and they change by 0.2 for each N m.
    assert kept["at"].item() == pytest.approx(symmetry_breaks(11.0, 13.0), abs=1e-7)
    assert " branch-point " in said.out and "a multiplier passes 1" not in said.out
    known = load_scenario("pendulum", case="ideal", overrides=[DRIVE, "drives.motor.amplitude='11 N*m'"])
    angle = simulate(known, duration=80.0).data["motion_angle"].sel(joint="hinge")
    swing = angle.sel(time=slice(80.0 - 1.6, None)).values
    # What is left of the start after 50 periods is 0.6^50 = 1e-11; a sampled top is short by 3.1e-5 at most.
    assert kept["amplitude"].values[0, 0] == pytest.approx(0.5 * np.ptp(swing), rel=3.2e-5)


def test_a_branch_is_of_the_period_that_is_given(cli):
    """Of two periods of the drive, over which damping takes what Liouville's formula says."""
    quick = ("pendulum", "--case", "ideal", "--set", DRIVE.replace("0.625 Hz", "6.25 Hz"))
    how = (*OVER, "1 N*m:1.2 N*m", "--arc", "2", "--transient", "10", "--period", "320 ms")
    assert cli("orbit", *quick, *how, "--out", "branch.nc").code == 0
    kept = open_branch("branch.nc")
    assert kept["value"].values[[0, -1]].tolist() == [1.0, 1.2]
    assert kept["period"].values == pytest.approx(0.32, rel=1e-12)
    multipliers = kept["multiplier_real"].values + 1j * kept["multiplier_imaginary"].values
    inertia = 0.0251004 + 1.872 * 0.2**2
    # Of exp(-3.8), a hundredth that is known to 1e-9.
    assert multipliers.prod(axis=1) == pytest.approx(np.exp(-1.2 / inertia * 0.32), rel=1e-6)


def test_what_is_interrupted_is_kept(cli, monkeypatch):
    """Ctrl-C at the second orbit: both are in the file, which says so, and the exit code is its own."""
    from antenna_pin.apps.cli import _progress

    known = []

    def interrupting(value):
        known.append(value)
        raise KeyboardInterrupt

    @contextlib.contextmanager
    def bar(title, ends, shown):
        assert ends == (1.0, 3.0) and shown
        yield interrupting

    monkeypatch.setattr("antenna_pin.apps.cli.orbit.branch_bar", bar)
    said = cli("orbit", *PENDULUM, *OVER, "1 N*m:3 N*m", "--arc", "0.2", "--out", "cut.nc")
    assert said.code == 130 and said.err.endswith("antenna-pin: interrupted\n")
    kept = open_branch("cut.nc")
    assert kept["value"].values.tolist() == [1.0, *known]
    assert (
        kept.attrs["message"] == f"it was interrupted at {known[0]:g}" and kept.attrs["message"] in said.out
    )
    with _progress.branch_bar("torque", (1.0, 3.0), True) as report:
        report(2.0)  # as it is given


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("orbit", *PENDULUM, "--values", "1:2"), "--values must be given with --over"),
        (("orbit", *PENDULUM, "-q", "v[hinge]"), "--quantity must be given with --over"),
        (("orbit", *PENDULUM, "--over", "drives.motor.amplitude"), "--values must be given with --over as"),
        (("orbit", *PENDULUM, *OVER, "1:2:3"), "--values must be given with --over as FIRST:LAST"),
        (("orbit", *PENDULUM, *OVER, "1 m:2 m"), "amplitude must be a torque [N*m] or a force [N]"),
        (("orbit", *PENDULUM, *OVER, "1:2", "--free-period"), "--free-period must be left out with --over"),
        (("orbit", *PENDULUM, *OVER, "1:2", "-q", "v[hing]"), "did you mean hinge"),
        (("orbit", *PENDULUM, *OVER, "1:1"), "values must be two different"),
        (("orbit", *PENDULUM, "--rtol", "1e-3"), "rtol must be above 0 and at most 1e-06"),
        (("orbit", *PENDULUM, "--out", "orbit.txt"), "name must end in .nc"),
        (("lyapunov", *PENDULUM, "--plot", "no/where.png"), "does not exist"),
        (("orbit", "pendulum", "--case", "ideal"), "drives must be periodic"),
        (("orbit", *PENDULUM, "--multiple", "0"), "--multiple must be 1 or more, got 0"),
        (("orbit", *PENDULUM, "--period", "0 s"), "--period must be positive"),
        (("lyapunov", *PENDULUM, "--count", "0"), "--count must be 1 or more, got 0"),
        (("lyapunov", *PENDULUM, "--interval", "5 kg"), "--interval"),
        (("lyapunov", *PENDULUM, "--interval", "9 s", "--count", "9"), "neighbours do not come together"),
    ],
)
def test_refusals(cli, refused, arguments, message):
    assert message in refused(cli(*arguments))
