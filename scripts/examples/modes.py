"""Modes of the antenna in its pose after 0.1 s, and how the motor moves its boresight at 10 Hz."""

from antenna_pin import load_scenario
from antenna_pin.studies.linear import frequency_response, modes

found = modes(load_scenario("bai2020", case="flexible-ideal"), at=0.1)
print([round(float(f), 3) for f in found.frequency if f > 0.0])  # [Hz]
answer = frequency_response(found, "drives.elevation", "boresight", [10.0])
print(answer["gain"].sel(target="boresight cross").item())  # [rad/(N m)]
