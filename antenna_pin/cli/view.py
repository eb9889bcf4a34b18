"""``antenna-pin view``: a run in 3D in the browser that pages are opened with, by one short command."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.cli._common import load_result, not_interrupted, say
from antenna_pin.cli._opening import browser_for_pages
from antenna_pin.cli._packages import PackagePathOption, package_folders
from antenna_pin.cli.record import CurveOption, IdealOption, JointOption, ViewName, ViewOption
from antenna_pin.errors import MissingToolError, OutputError

if TYPE_CHECKING:
    from antenna_pin.record import Recording


def view(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Result file of a run.")],
    ideal: IdealOption = None,
    view: ViewOption = ViewName.MECHANISM,
    joint: JointOption = None,
    curve: CurveOption = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="NAME.html", help="The page; if left out, beside the result, or in a temporary folder."
        ),
    ] = None,
    package_path: PackagePathOption = None,
    browser: Annotated[bool, typer.Option(help="Open the page, or only make it and print its path.")] = True,
) -> None:
    """Show a run in 3D in the browser: make its page and open it.

    The page is one that record makes; it stays, and can be opened again.
    """
    from antenna_pin.base.files import check_writable

    opened = browser_for_pages("view", "--no-browser makes the page and prints its path") if browser else None
    target = check_writable(out, ".html") if out is not None else None
    packages = package_folders(package_path)
    run = load_result(file)
    reference = None if ideal is None else load_result(ideal)

    from antenna_pin.record import record as make

    recording = make(
        run,
        reference,
        view=view.value,
        joint=joint,
        curves=curve or None,
        package_path=packages,
    )
    for text in (*recording.data["warnings"], *recording.data["thinned"]):
        say(f"note: {text}")
    with not_interrupted():
        page = recording.save(target) if target is not None else _beside(recording, file)
        typer.echo(f"saved {page}")
    if opened is not None and not opened.open(page.resolve().as_uri()):
        raise MissingToolError(f"view: a browser must start, got none; open {page} in one")


def _beside(recording: Recording, file: Path) -> Path:
    """Write the page beside the result, where browsers that see home folders only find it; else elsewhere."""
    try:
        return recording.save(file.with_name(f"{file.stem}.view.html"))
    except OutputError:
        return recording.save(Path(tempfile.mkdtemp(prefix="antenna-pin-")) / "run.view.html")
