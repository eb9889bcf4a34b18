from antenna_pin.run.session.session import EndedError as EndedError
from antenna_pin.run.session.session import InUseError as InUseError
from antenna_pin.run.session.session import Session as Session
from antenna_pin.run.session.session import start as start
