"""``antenna-pin orbit`` and ``lyapunov``: what they print, and what they refuse in one line."""

import json

import pytest

DRIVE = "drives.motor={joint='hinge', kind='sine', amplitude='1 N*m', frequency='0.625 Hz'}"
PENDULUM = ("pendulum", "--case", "ideal", "--set", DRIVE)


def test_an_orbit_is_told(cli):
    """The damped pendulum comes to the period of its drive; by one count of multipliers and exponents."""
    said = cli("orbit", *PENDULUM, "--json")
    found = json.loads(said.out)
    assert said.code == 0 and found["stable"] and found["residual"] < 1e-9
    assert found["period"] == pytest.approx(1.6) and len(found["multipliers"]) == 2
    told = cli("orbit", *PENDULUM)
    assert told.out.startswith("orbit of 1.6 s, stable") and f"{found['exponents'][0]:.4g}" in told.out


def test_exponents_are_told_with_their_error(cli, tmp_path):
    table = tmp_path / "exponents.csv"
    said = cli("lyapunov", *PENDULUM, "--interval", "0.2 s", "--count", "40", "--csv", str(table))
    assert said.code == 0 and table.read_text().startswith("exponent [1/s],error [1/s]\n-")
    short = cli("lyapunov", *PENDULUM, "--interval", "0.2 s", "--count", "4")
    assert short.out.startswith("too short to say, over 4 intervals")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("orbit", "pendulum", "--case", "ideal"), "drives must be periodic"),
        (("orbit", *PENDULUM, "--multiple", "0"), "--multiple must be 1 or more, got 0"),
        (("orbit", *PENDULUM, "--period", "0 s"), "--period must be positive"),
        (("lyapunov", *PENDULUM, "--count", "0"), "--count must be 1 or more, got 0"),
        (("lyapunov", *PENDULUM, "--interval", "5 kg"), "--interval"),
        (("lyapunov", *PENDULUM, "--interval", "9 s", "--count", "9"), "neighbours do not come together"),
    ],
)
def test_refusals(cli, arguments, message):
    said = cli(*arguments)
    assert said.code == 2 and len(said.err.splitlines()) == 1 and message in said.err
