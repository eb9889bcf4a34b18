from antenna_pin.apps import cli as cli
from antenna_pin.apps import fmu as fmu
from antenna_pin.apps import live as live
