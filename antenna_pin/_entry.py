"""Where the installed command starts: until everything is imported, Ctrl-C ends the process without a word.

Python would print a traceback from wherever an import has come. Only the command imports this module.
"""

import signal
import sys

__all__ = ["main"]

_asked = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if _asked:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def main() -> None:
    """Run the command line."""
    # xarray and pint load Dask where it is installed, for a second; nothing here uses it. As if it were not.
    sys.modules.setdefault("dask", None)  # type: ignore[arg-type]
    from antenna_pin.cli import main as run

    if _asked:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run()
    finally:  # Python takes itself down: nothing is left to be saved, and no traceback of use
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
