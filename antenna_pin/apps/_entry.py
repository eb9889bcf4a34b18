"""Entry of the installed command; Ctrl-C during its imports ends the process silently.

Python would print a traceback from wherever an import has come. Only the command imports this module.
"""

import _signal as signal  # type: ignore[import-not-found]  # built in; `signal` itself takes long to import
import gc
import os
import sys


def main() -> None:
    """Run the command line."""
    is_handled = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_handled:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Imports make many objects and no garbage: Python looks for some for a tenth of their time.
    gc.set_threshold(500_000, 20, 20)
    # pydantic would look through all that is installed for plugins that watch what it checks.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from antenna_pin.base.interruption import late_signal
    from antenna_pin.base.lazy import go_without

    go_without("dask", "pint")  # which xarray loads, for a second, to see whether it is given their arrays
    from antenna_pin.apps.cli import main as run

    if is_handled:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run()
    finally:  # Python takes itself down: nothing is left to be saved, and no traceback of use
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        if (late := late_signal()) is not None:  # come too late to interrupt anything
            sys.stdout.flush()
            signal.raise_signal(late)
        # On its way down Python looks for garbage three times, a fifth of the time of a short run.
        gc.freeze()
