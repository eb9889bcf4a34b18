"""``antenna-pin export``: scenarios as what other tools step and command."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer.core import TyperCommand

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, say, stem, writable_file
from antenna_pin.apps.cli._options import argument, option
from antenna_pin.apps.cli._usage import command_group

app = command_group("export", "Export scenarios: as a functional mock-up unit.")

_LISTS = ("--inputs", "--outputs", "--parameters")


class WithLists(TyperCommand):
    """Command with options that take all words up to the next option."""

    def parse_args(self, context: Any, args: list[str]) -> list[str]:
        """Read the words, each behind its option."""
        read: list[str] = []
        option, words = "", 0
        for word in args:
            if word.startswith("-"):
                option, words = (word, 0) if word in _LISTS else ("", 0)
                read.append(word)
            else:
                read += [option, word] if option and words else [word]
                words += 1
        return super().parse_args(context, read)


@app.command("fmu", cls=WithLists)
def fmu(
    scenario: Annotated[str, argument("Name of a shipped one, or a file.", "SCENARIO")],
    case: options.Case = None,
    outputs: Annotated[
        list[str] | None, option("Outputs: hinge.angle, hinge.rate, motion_angle[hinge].", "NAME...")
    ] = None,
    inputs: Annotated[list[str] | None, option("Inputs: motor, springs.coil.stiffness.", "NAME...")] = None,
    parameters: Annotated[
        list[str] | None,
        option(
            "Numbers of the scenario to be set before the start: initial.joints.hinge.position.", "PLACE..."
        ),
    ] = None,
    out: Annotated[Path | None, option("File, NAME.fmu; NAME-CASE.fmu here if left out.")] = None,
    settings: options.Set = None,
) -> None:
    """Write a scenario as an FMU for co-simulation (FMI 3.0), URDF and meshes included.

    Options of names take several words, up to the next option. The tool that runs the unit needs a Python
    with antenna_pin.
    """
    chosen = load(scenario, case, settings)
    path = writable_file(out or Path(f"{stem(chosen)}.fmu"), ".fmu")
    from antenna_pin.apps.fmu import export_fmu

    made = export_fmu(chosen, path, inputs=inputs or (), outputs=outputs or (), parameters=parameters or ())
    say(f"saved {made}")
