"""The four-bar of single_loops with its crank driven: without play, with play in the crank's pin, held."""

from __future__ import annotations

from pathlib import Path

from single_loops import four_bar

_CASES = """\
[drives.crank]
kind = "motion"
joint = "drive_pin"
rate = 12.0

[clearance.crank_pin]
model = "contact"
radial_clearance = "0.1 mm"
axial_clearance = "0.1 mm"
bearing_radius = "10 mm"
bearing_length = "20 mm"
bearing_outer_radius = "15 mm"
flange_radius = "15 mm"
geometry = "closed-form"
normal = { law = "lankarani-nikravesh", stiffness = 1e8, restitution = 0.9 }
friction = { law = "tanh", coefficient_of_friction = 0.03, transition_speed = "1 mm/s" }

[integrator]
rtol = 1e-9

[output]
rate = "1 kHz"

[cases.ideal]
description = "no play"
clearance.crank_pin.model = "ideal"

[cases.play]
description = "play in the crank's pin"

[cases.held]
description = "the crank's pin by constraint"
[cases.held.clearance.crank_pin]
model = "constraint"
"""

# Of the links, along their x axis, for pictures [m].
_LENGTHS = {"crank": 0.1, "coupler": 0.3, "rocker": 0.25}


def write_driven_four_bar(folder: Path) -> Path:
    """Write URDF and scenario into a folder, made if missing; return the scenario's path."""
    loop = four_bar()
    urdf = loop.urdf
    for link, length in _LENGTHS.items():
        shape = f'<origin xyz="{length / 2} 0 0"/><geometry><box size="{length} 0.02 0.02"/></geometry>'
        urdf = urdf.replace(f'<link name="{link}">', f'<link name="{link}"><visual>{shape}</visual>')
    folder.mkdir(exist_ok=True)
    (folder / "loop.urdf").write_text(urdf)
    head = loop.scenario.split("[initial.joints.drive_pin]")[0]
    head = head.replace('duration = "1 s"', 'duration = "0.1 s"\ndefault_case = "ideal"')
    path = folder / "scenario.toml"
    path.write_text(head.replace("set going under gravity", "its crank driven") + _CASES)
    return path
