"""Modes of an antenna with flexible petals, and how its motor moves the boresight.

Small motions about the pose after 0.1 s: thin lines stand at the natural frequencies.
"""

from antenna_pin import load_scenario
from antenna_pin.studies.linear import modes

found = modes(load_scenario("bai2020", case="flexible-ideal"), at=0.1)
print(", ".join(f"{one:.1f} Hz" for one in found.frequency if one > 0.0))
figure = found.plot("drives.elevation", ["boresight"])
