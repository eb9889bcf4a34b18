from antenna_pin.studies.statics.equilibria import equilibria as equilibria
from antenna_pin.studies.statics.result import Equilibrium as Equilibrium
from antenna_pin.studies.statics.result import QuasiStaticTravel as QuasiStaticTravel
from antenna_pin.studies.statics.result import StaticContact as StaticContact
from antenna_pin.studies.statics.result import StaticStability as StaticStability
from antenna_pin.studies.statics.torque_angle import TorqueAngleLoop as TorqueAngleLoop
from antenna_pin.studies.statics.torque_angle import torque_angle_loop as torque_angle_loop
from antenna_pin.studies.statics.quasi_static import travel as travel
