"""Equilibrium of a pendulum, and the torque that moves it quasi-statically."""

from antenna_pin.studies.statics import statics

hanging = statics("pendulum").equilibria[0]
moved = statics("pendulum", "hinge", start="-30 deg", stop="30 deg", count=5).travel
print(hanging.stability, moved.torque - moved.torque_back)
