"""Two parts of a run are the whole bit for bit, whatever has kinks, wherever it is cut."""

import numpy as np
import pytest
from wheel import wheel_urdf

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    BoucWen,
    ConstantSpring,
    DahlFriction,
    EndStop,
    GonthierFriction,
    HarnessSpring,
    JointSpring,
    LuGreFriction,
    MaxwellSlip,
    PDController,
    RigidLatch,
    RigidStop,
    SineDrive,
    StickingFriction,
    TableSpring,
)
from antenna_pin.mechanism import build_mechanism
from antenna_pin.run.simulation import Angle, Event, Mark, Rate
from antenna_pin.run.simulation.element_events import own_events
from tests.reference import every_kind

SPAN = 1.5  # [s]
WEN = {"alpha": 0.3, "stiffness": 2.0, "yield_angle": 0.05}
KINKS = {
    "bouc-wen": {"springs": {"s": BoucWen(joint="axle", **WEN)}},
    "bouc-wen, one kink": {"springs": {"s": BoucWen(joint="axle", gamma=0.0, beta=1.0, **WEN)}},
    "two of them": {
        "springs": {
            "s": BoucWen(joint="axle", exponent=1.5, **WEN),
            "t": BoucWen(joint="axle", start=0.4, **WEN),
        }
    },
    "gonthier": {
        "frictions": {
            "s": GonthierFriction(
                joint="axle",
                coulomb=0.1,
                static=0.2,
                stribeck_rate=0.2,
                stiffness=5.0,
                damping=0.05,
                dwell_time=0.1,
            )
        }
    },
    "dahl": {"frictions": {"s": DahlFriction(joint="axle", coulomb=0.1, stiffness=5.0, shape=1.5)}},
    "lugre": {
        "frictions": {
            "s": LuGreFriction(
                joint="axle", coulomb=0.1, static=0.15, stribeck_rate=0.2, stiffness=5.0, damping=0.05
            )
        }
    },
    "slips": {"springs": {"s": MaxwellSlip(joint="axle", stiffness=(2.0, 1.0), slip=(0.05, 0.2))}},
    "harness and table": {
        "springs": {
            "s": HarnessSpring(
                joint="axle", angle=(-1.0, 1.0), torque=(0.2, -0.4), torque_back=(0.3, -0.2), reversal=0.05
            ),
            "t": TableSpring(joint="axle", angle=(-0.1, 0.1), torque=(0.1, -0.1)),
        }
    },
    "limits": {
        "drives": {"p": PDController(joint="axle", kp=5.0, kd=0.3, angle=0.2, limit=0.3)},
        "springs": {"s": ConstantSpring(joint="axle", torque=0.3, upper=0.1, ramp=0.05)},
    },
    "soft stop": {"stops": {"s": EndStop(joint="axle", upper=0.1, stiffness=90.0, restitution=0.6)}},
    "latch that is overcome": {
        "latches": {"l": RigidLatch(joint="axle", angle=0.05, width=0.01, holding_torque=0.5)}
    },
    "stop and friction": {
        "stops": {"s": RigidStop(joint="axle", upper=0.1, restitution=0.6)},
        "frictions": {"f": StickingFriction(joint="axle", coulomb=0.05)},
    },
}
#: Beside each, events whose memory must not be taken for that of another.
MARKS = (
    Event(name="passes", when=Angle("axle", 0.05), action=Mark()),
    Event(name="turns", when=Rate("axle"), action=Mark()),
)


def _system(name):
    more = dict(KINKS[name])
    drives = {"d": SineDrive(joint="axle", amplitude=0.9, frequency=1.3), **more.pop("drives", {})}
    springs = {"coil": JointSpring(joint="axle", stiffness=5.0), **more.pop("springs", {})}
    return System(
        build_mechanism(wheel_urdf("revolute"), "fixed"), drives=drives, springs=springs, elements=more
    )


@pytest.mark.parametrize("engine", [pytest.param("pinocchio", marks=pytest.mark.slow), "compiled"])
@pytest.mark.parametrize("name", KINKS)
def test_two_halves_are_the_whole_wherever_they_are_cut(name, engine):
    system, settings = _system(name), RunSettings(rtol=1e-8, engine=engine, output_rate=20.0)
    given = {"settings": settings, "events": MARKS}
    whole = simulate(system, duration=SPAN, q=[-0.1], v=[-0.7], **given)
    assert whole.completed
    for cut in np.random.default_rng(5).uniform(0.02, SPAN - 0.02, 4).tolist():
        first = simulate(system, duration=cut, q=[-0.1], v=[-0.7], **given)
        rest = simulate(system, duration=SPAN - first.end.reached, start=first.end, **given)
        assert rest.end == whole.end, cut


def test_whatever_a_run_looks_for_has_a_name_of_its_own():
    """By their names a run that goes on knows what it remembers of each."""
    for system in (every_kind.elements(every_kind.DRIVES, every_kind.FORCES), every_kind.with_modes()):
        names = [event.name for event in own_events(system)]
        assert len(names) > 10
        assert len(set(names)) == len(names)
