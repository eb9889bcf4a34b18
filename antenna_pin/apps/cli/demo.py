"""``antenna-pin demo``: the first example, from a run to a report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_folder, load
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli.info import info, plot
from antenna_pin.apps.cli.report import report
from antenna_pin.apps.cli.run import run

_CASES = ("case1", "case3")


def demo(
    out: Annotated[Path, option("Folder for all results; created if missing.", "DIR")] = Path("demo"),
    duration: options.Duration = "5 s",
) -> None:
    """Run the shipped antenna without and with play; save results, figures, a report."""
    figure_folder(out)
    load("bai2020", _CASES[0], (), duration=duration)  # refused before there is a folder
    out.mkdir(parents=True, exist_ok=True)
    files = [out / f"{case}.nc" for case in _CASES]
    for case, file in zip(_CASES, files, strict=True):
        run("bai2020", case=case, duration=duration, out=file, summary=False)
    info([str(file) for file in files])
    plot(files, out)
    report(files, out / "report.html")
