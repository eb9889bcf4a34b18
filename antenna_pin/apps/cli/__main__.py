"""``python -m antenna_pin.apps.cli``."""

from antenna_pin.apps.cli import main

main()
