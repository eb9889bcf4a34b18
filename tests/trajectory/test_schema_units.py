"""Units of what a result holds: those that the names tell."""

from antenna_pin.trajectory.schema import VARIABLES

#: By a word of the name, the last one that stands here. Where a joint slides there is a metre for a radian.
UNITS = {
    word: set(units.split(", "))
    for units, words in {
        "1": "attitude bend contact controller dwell mode scenario signal ticks touching",
        "A": "current",
        "J": "dissipated dissipation energy heat loss work",
        "N": "force tension",
        "N m": "effort moment torque",
        "N s, N m s": "impulse",
        "N s, N m s, kg m/s, kg m^2/s": "momentum",
        "kg": "mass",
        "m": "depth gap length place point position",
        "m/s": "speed",
        "m/s, rad/s": "rate velocity",
        "m/s^2, rad/s^2": "acceleration",
        "rad": "angle control deflection",
        "rad, 1": "tilt",
        "rad/s": "spin",
        "s": "time",
    }.items()
    for word in words.split()
}
#: Whose units go with the joint: those of a configuration, of velocities and of accelerations.
OF_JOINTS = {"q", "v", "a"}


def word_of(name):
    """Return the last word of a name that has units."""
    if name.startswith("time_of_"):
        return "time"
    return next((word for word in reversed(name.split("_")) if word in UNITS), None)


def test_a_unit_is_that_of_the_name():
    wrong = {
        name: VARIABLES[name].units
        for name in VARIABLES.keys() - OF_JOINTS
        if VARIABLES[name].units not in UNITS[word_of(name)]
    }
    assert not wrong
