"""``python -m antenna_pin.cli``."""

from antenna_pin.cli import main

main()
