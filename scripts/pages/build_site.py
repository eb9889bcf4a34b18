"""Lay out the source of the site, build it, and check what was built; ``scripts/docs`` calls it.

The source is laid out under ``build/docs/source`` as the checkout is, so that links between pages are those
that hold on GitHub; generated pages are added there. Nothing is written into the checkout.
"""

from __future__ import annotations

import signal

if __name__ == "__main__":  # until all is imported, Ctrl-C ends it without a word
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import argparse
import functools
import http.server
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from antenna_pin.base.interruption import ended_by, ending_by_signals

ROOT = Path(__file__).parents[2]
BUILT = ROOT / "build" / "docs"


def build(built: Path = BUILT, *, anew: bool = False) -> Path:
    """Build the site and return its folder; the process ends where Sphinx has a warning.

    Args:
        built: Folder for source, site and what is kept between builds.
        anew: Whether nothing of an earlier build is used: scripts and notebooks are run again, too.
    """
    from laid_out import lay_out  # which imports for seconds, and is ended in one line then, too

    source, site, kept = built / "source", built / "site", built / "kept"
    if anew:
        shutil.rmtree(built, ignore_errors=True)
    lay_out(source)
    options = [
        "-W",
        "--keep-going",
        "-q",
        "-j",
        "2",
        "-d",
        str(kept),
        "-D",
        f"nb_execution_cache_path={built}/cells",
    ]
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-c", str(source / "docs")]
    environment = os.environ | {
        "IPYTHONDIR": str(quiet_kernels(built / "ipython")),
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]),
    }
    words = [*command, *options, str(source), str(site)]
    with subprocess.Popen(words, env=environment, process_group=0) as sphinx:
        try:
            sphinx.wait()
        except KeyboardInterrupt:
            os.killpg(sphinx.pid, signal.SIGKILL)  # with its processes
            raise
    if sphinx.returncode:
        raise SystemExit("docs: not built; the warnings above say why")
    return site


def quiet_kernels(folder: Path) -> Path:
    """Return a folder of settings by which notebooks' kernels say nothing of how they are connected."""
    profile = folder / "profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    (profile / "ipython_kernel_config.py").write_text("c = get_config()\nc.IPKernelApp.log_level = 40\n")
    return folder


def serve(site: Path) -> None:
    """Show the site on this machine until it is interrupted."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(site))
    with http.server.ThreadingHTTPServer(("localhost", 8000), handler) as server:
        print("http://localhost:8000 (Ctrl+C ends it)")
        server.serve_forever()


def main() -> int:
    """Build, and check or show what was built; Ctrl-C and SIGTERM end it in one line."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    ending_by_signals()
    try:
        return _main()
    except KeyboardInterrupt:
        print("docs: interrupted", file=sys.stderr)
        return 128 + ended_by()


def _main() -> int:
    parser = argparse.ArgumentParser(prog="scripts/docs", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true", help="build anew, check links, anchors and sizes")
    parser.add_argument("--serve", action="store_true", help="show it under http://localhost:8000")
    asked = parser.parse_args()
    from verdict import complaints

    begun = time.monotonic()
    site = build(anew=asked.check)
    print(f"{(site / 'index.html').relative_to(ROOT)}: built in {time.monotonic() - begun:.0f} s")
    found = complaints(site) if asked.check else []
    for line in found:
        print(line)
    if asked.serve:
        serve(site)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
