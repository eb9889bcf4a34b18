"""A scenario file with every table, and a folder in which it is changed, loaded and refused."""

import copy
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import strategies as st

from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.scenario import load_scenario
from antenna_pin.scenario.merge import toml_value

URDF = '<robot name="r"><link name="body"/></robot>\n'
TORQUE = "time,torque\n0,0\n0.5,1.25\n1,-1e-3\n"

# Every table occurs, with values that differ from the defaults.
FILE = {
    "format": 1,
    "title": "A test",
    "source": "none",
    "duration": "2 s",
    "mechanism": {
        "urdf": "body.urdf",
        "gravity": [0, 0, "-9.81 m/s**2"],
        "allow_impossible_inertia": ["body"],
        "links": {
            "body": {
                "mass": "1 t",
                "inertia": [1, 2, "3 kg*m**2"],
                "centre_of_mass": ["1 mm", 0, 0],
                "shapes": {"box": {"size": [1, "20 cm", 3]}, "rod": {"radius": "5 cm", "length": "1 m"}},
            }
        },
        "joints": {"azimuth": {"origin_xyz": [0, 0, 0.5], "origin_rpy": [0, 0, "90 deg"], "axis": [0, 0, 2]}},
    },
    "materials": {
        "alloy": {"young": "70 GPa", "poisson": 0.33, "density": "2700 kg/m**3", "source": "a book"}
    },
    "clearance": {
        "hinge": {
            "model": "contact",
            "bearing_radius": "10 mm",
            "radial_clearance": "0.2 mm",
            "bearing_length": "50 mm",
            "axial_clearance": "0.2 mm",
            "bearing_outer_radius": "12 mm",
            "flange_radius": "14 mm",
            "offset": "-1 mm",
            "geometry": "closed-form",
            "approach_speed_floor": "0.2 mm/s",
            "maximum_depth": "0.1 mm",
            "journal_material": "steel",
            "bearing_material": "alloy",
            "normal": {"law": "lankarani-nikravesh", "restitution": 0.9},
            "axial": {"stiffness": "1e11 N/m**1.5"},
            "friction": {"law": "tanh", "coefficient_of_friction": 0.1, "transition_speed": "1 mm/s"},
        }
    },
    "drives": {
        "azimuth": {"kind": "sine", "amplitude": "10 N*m", "frequency": "1 Hz", "phase": "90 deg"},
        "motor": {"joint": "hinge", "kind": "constant", "value": "4 N*m", "axis": "journal"},
        "slow": {"joint": "azimuth", "kind": "table", "file": "torque.csv", "interpolation": "cubic"},
    },
    "springs": {"azimuth": {"stiffness": "3 N*mm/rad", "damping": "1 N*m*s/rad", "rest_angle": "1 deg"}},
    "initial": {
        "joints": {
            "azimuth": {"position": "10 deg", "velocity": "1 rpm"},
            "hinge": {"angle": 0.1, "rate": 0.2, "journal_position": ["10 um", 0, 0]},
        },
        "base": {
            "position": [1, 2, "3 km"],
            "attitude": [0, 0, 0.6, 0.8],
            "angular_velocity": [0, 0, "1 rpm"],
        },
    },
    "integrator": {
        "method": "rk4",
        "rtol": 1e-7,
        "step": "20 us",
        "first_step": "1 us",
        "scales": {"angle": "1 mrad", "clearance": 0.5},
    },
    "output": {"rate": "2 kHz"},
    "pointing": {
        "body": "body",
        "boresight": [0, 0, -2],
        "up": [1, 0, 0.5],
        "commanded": "orbit",
        "direction": [0, 0.1, 1],
        "direction_up": [1, 0, 0],
        "orbit": {"altitude": "500 km", "normal": [0, 0, 2], "nadir": [-3, 0, 0]},
    },
    "cases": {
        "tight": {"description": "less play", "clearance": {"hinge": {"radial_clearance": "10 um"}}},
        "by-radius": {"clearance": {"hinge": {"journal_radius": "9.9 mm", "flange_distance": "50.1 mm"}}},
        "elastic": {"clearance": {"hinge": {"normal": {"replace": True, "law": "hertz"}}}},
    },
}
DELETED = object()
# Of keys of the joint with play.
H = "clearance.hinge."


# Any tables that TOML has.
TABLES = st.recursive(
    st.integers() | st.text(max_size=3),
    lambda inner: st.dictionaries(st.sampled_from("abc"), inner, max_size=3),
    max_leaves=8,
)


@dataclass
class Folder:
    """A folder with a scenario file ``my.toml`` and the files it names, as the current folder."""

    path: Path

    def load(self, changes=(), case=None, overrides=(), file=FILE):
        """Write the file with the changes, given by dotted key, and load it."""
        document = copy.deepcopy(file)
        for dotted, value in dict(changes).items():
            table = document
            *outer, last = dotted.split(".")
            for key in outer:
                table = table.setdefault(key, {})
            if value is DELETED:
                del table[last]
            else:
                table[last] = value
        lines = [f"{key} = {toml_value(value)}" for key, value in document.items()]
        (self.path / "my.toml").write_text("\n".join(lines), encoding="utf-8")
        return load_scenario("my.toml", case, overrides)

    def refusal(self, changes=(), case=None, overrides=(), error=ScenarioError):
        """Return the message with which the file is refused, without the file's name."""
        with pytest.raises(AntennaPinError) as refused:
            self.load(changes, case, overrides)
        message = str(refused.value)
        assert type(refused.value) is error
        assert len(message.splitlines()) == 1
        assert message.startswith("my.toml: ")
        return message.removeprefix("my.toml: ")
