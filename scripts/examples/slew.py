"""A slew within limits of rate, acceleration and jerk."""

from math import radians

from antenna_pin.elements import PrescribedMotion, SCurve

slew = SCurve(end=radians(90), rate=radians(10), acceleration=radians(5), jerk=radians(20), start=2.0)
motion = PrescribedMotion(joint="azimuth", follows=slew)
print(f"{slew.duration:.4f} s; at 5 s {slew.at(5.0)[1]:.4f} rad/s")
