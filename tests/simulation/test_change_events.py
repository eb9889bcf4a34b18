"""Events on what elements and contacts do: where they happen, what they set, and how often."""

import pytest
from wheel import wheel_text

from antenna_pin import Outcome, load_scenario, simulate
from antenna_pin.errors import AntennaPinError

INERTIA, RATE = 2.0, 0.5
# Of a time at a constant rate, which steps reach to the round-off of its dense output [s].
EXACT = 1e-9


@pytest.fixture
def wheel(tmp_path):
    """Return a function that runs a wheel of 2 kg m^2 at 0.5 rad/s with elements and events given as text."""
    (tmp_path / "wheel.urdf").write_text(wheel_text(inertia=INERTIA, joint="hinge"))

    def made(text, duration=2.0):
        path = tmp_path / "wheel.toml"
        path.write_text(
            f'format = 1\nduration = {duration}\n[mechanism]\nurdf = "wheel.urdf"\nbase = "fixed"\n'
            f"[initial.joints.hinge]\nrate = {RATE}\n[integrator]\nrtol = 1e-11\n{text}"
        )
        return simulate(load_scenario(path))

    return made


def times(run, name):
    return run.data["event_time"].values[run.data["event"].values == name].tolist()


def test_a_capture_sets_several_numbers_and_a_release_at_the_same_instant_ends_the_run(wheel):
    """Captured at 0.4 s it is pushed by more than the latch holds: it lets go there."""
    latch = '[latches.hinge]\nkind = "rigid"\nangle = 0.2\nholding_torque = 1\n'
    pushes = '[drives.a]\njoint = "hinge"\nkind = "constant"\nvalue = 0.4\non = false\n'
    pushes += '[drives.b]\njoint = "hinge"\nkind = "constant"\nvalue = 1e-9\n'
    caught = '[events.caught]\nkind = "change"\nof = "latches.hinge"\nchange = "capture"\naction = "set"\n'
    caught += 'set = { "drives.a.on" = true, "drives.b.value" = "0.8 N*m" }\n'
    freed = '[events.freed]\nkind = "change"\nof = "latches.hinge"\nchange = "release"\n'
    run = wheel(latch + pushes + caught + freed + 'action = ["mark", "stop"]\n')
    assert times(run, "caught") == pytest.approx([0.4], abs=EXACT)
    assert times(run, "freed") == times(run, "caught")
    assert run.outcome is Outcome.STOPPED and run.message.startswith("at t = 0.4 s, event 'freed'")


@pytest.mark.parametrize(("once", "changed"), [("false", 2), ("true", 1)])
def test_a_touch_is_acted_on_once_or_each_time(wheel, once, changed):
    """It touches the upper of two stops every 0.8 s at first, which sets a drive on; the lower one off."""
    stop = '[stops.hinge]\nkind = "rigid"\nlower = 0.0\nupper = 0.2\nrestitution = 1\n'
    drive = '[drives.hinge]\nkind = "constant"\nvalue = 0.1\non = false\n'
    event = (
        '[events.{}]\nkind = "change"\nof = "stops.hinge"\nchange = "touch"\nside = "{}"\naction = "set"\n'
    )
    event += 'set = "drives.hinge.on"\nto = {}\n'
    on = event.format("on", "upper", "true") + f"once = {once}\n"
    off = event.format("off", "lower", "false")
    run = wheel(stop + drive + on + off, duration=2.0)
    # Pushed on its way down, which takes its energy by 0.02 J each time that the drive is on.
    energy = 0.5 * INERTIA * run.data["v"].values[-1, 0] ** 2
    assert times(run, "on")[0] == pytest.approx(0.4, abs=EXACT) and len(times(run, "on")) == 2
    assert energy == pytest.approx(
        0.5 * INERTIA * RATE**2 - 0.02 * (len(times(run, "off")) if changed == 2 else 1)
    )


def test_a_friction_that_sticks_is_an_event(wheel):
    """Dry friction of 0.5 N m stops it after I w / T = 2 s."""
    friction = "[frictions.hinge]\ncoulomb = 0.5\n"
    event = '[events.stuck]\nkind = "change"\nof = "frictions.hinge"\nchange = "stick"\naction = "stop"\n'
    run = wheel(friction + event, duration=5.0)
    assert run.outcome is Outcome.STOPPED
    assert times(run, "stuck") == pytest.approx([INERTIA * RATE / 0.5], abs=EXACT)


def test_a_contact_that_touches_and_lifts_off_is_an_event():
    """The events of a contact are the onsets and releases of its episodes."""
    contact = "bore.radial+"
    free = simulate(load_scenario("impact_pair", case="contact"), duration=5e-3)
    contact = str(free.data["contact"].values[int(free.data["episode_contact"].values[0])])
    events = {
        "events.on": {"kind": "change", "of": contact, "change": "touch"},
        "events.off": {"kind": "change", "of": contact, "change": "lift-off"},
    }
    run = simulate(load_scenario("impact_pair", case="contact", overrides=events), duration=5e-3)
    mine = run.data["episode_contact"].values == run.data["contact"].values.tolist().index(contact)
    onsets, releases = (run.data[f"{name}_time"].values[mine] for name in ("onset", "release"))
    assert len(onsets) > 0
    assert times(run, "on") == pytest.approx(onsets, abs=1e-12)
    assert times(run, "off") == pytest.approx(releases[releases == releases], abs=1e-12)


REFUSED = [
    ('of = "latches.hing"\nchange = "capture"', "'latches.hing' is unknown; did you mean latches.hinge"),
    ('of = "latches.hinge"\nchange = "capturd"', "known: capture, refusal, release"),
    ('of = "latches.hinge"\nchange = "capture"\nside = "upper"', "side of latches.hinge 'upper' is unknown"),
    ('of = "nothing"\nchange = "touch"', "contact 'nothing' is unknown"),
    ('of = "latches.hinge"\nchange = "capture"\naction = ["set", "stop"]', "set is missing; give it"),
    (
        'of = "latches.hinge"\nchange = "capture"\naction = "set"\nset = { "latches.hinge.on" = 3 }',
        'set."latches.hinge.on" must be true or false, got 3',
    ),
    (
        'of = "latches.hinge"\nchange = "capture"\naction = "set"\nset = "latche.hinge.on"\nto = false',
        "did you mean latches.hinge? known: latches.hinge",
    ),
]


@pytest.mark.parametrize(("text", "said"), REFUSED)
def test_what_no_event_can_be_about_is_refused_with_what_there_is(wheel, text, said):
    with pytest.raises(AntennaPinError) as refusal:
        wheel(f'[latches.hinge]\nkind = "rigid"\nangle = 0.2\n[events.e]\nkind = "change"\n{text}\n')
    assert said in str(refusal.value)


def test_a_scenario_without_elements_says_so_where_an_event_sets_one(wheel):
    with pytest.raises(AntennaPinError, match="set must be of an element, .* but the scenario has none"):
        wheel('[events.e]\nkind = "time"\ntime = 1\naction = "set"\nset = "drives.motor.on"\nto = true\n')
