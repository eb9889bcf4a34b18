"""Equilibrium of a pendulum, and the torque that moves it quasi-statically."""

from antenna_pin.studies.statics import equilibria, travel

hanging = equilibria("pendulum")[0]
moved = travel("pendulum", "hinge", start="-30 deg", stop="30 deg", count=5)
print(hanging.stability, moved.torque - moved.torque_back)
