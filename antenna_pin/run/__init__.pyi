from antenna_pin.run import engine as engine
from antenna_pin.run import session as session
from antenna_pin.run import simulation as simulation
