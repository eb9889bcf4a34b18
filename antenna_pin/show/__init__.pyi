from antenna_pin.show import plot as plot
from antenna_pin.show import record as record
from antenna_pin.show import report as report
from antenna_pin.show import views as views
