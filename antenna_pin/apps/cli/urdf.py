"""``antenna-pin urdf``: the URDF of a case, and checks of URDFs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import REFUSED, load, package_folders, refuse, say, stem, writable_file
from antenna_pin.apps.cli._options import argument, flag, option

if TYPE_CHECKING:
    from antenna_pin.mechanism import Mechanism, Urdf, WrittenUrdf

# Names that are those of URDFs, or of what becomes one.
_SUFFIXES = (".urdf", ".xacro")


def urdf(
    targets: Annotated[
        list[str],
        argument(
            "A scenario; with --check URDF files, folders of them and scenarios, any number.",
            "SCENARIO|FILE...",
        ),
    ],
    check: Annotated[bool, flag("--check", "Report for each the ignored, assumed or refused parts.")] = False,
    case: options.Case = None,
    out: Annotated[
        Path | None, option("URDF file; NAME-CASE.urdf here if left out. With --check a text file.")
    ] = None,
    copy_meshes: Annotated[
        bool, flag("--copy-meshes", "Copy the mesh files into its folder, so that the folder can be moved.")
    ] = False,
    package_path: options.PackagePath = None,
    settings: options.Set = None,
) -> None:
    """Write the URDF of a case, or check which parts of URDFs are used (--check).

    Joints with clearance are free in it, so that other tools can load it; paths of meshes are relative. With
    --check the exit code is 0 if all load, else 2.
    """
    roots = package_folders(package_path)
    if check:
        if copy_meshes:
            refuse("urdf: --copy-meshes must be left out with --check, which writes no URDF")
        _check(targets, case, settings, roots, out)
        return
    if len(targets) > 1 or _is_urdf(targets[0]):
        refuse(
            f"urdf: must be given one SCENARIO to write its URDF, got {' '.join(targets)}; "
            "--check reports what is read from URDF files"
        )
    changes = list(settings or ())
    if roots:
        changes.append(f"mechanism.package_path=[{', '.join(repr(str(root)) for root in roots)}]")
    chosen = load(targets[0], case, changes)
    path = writable_file(out or Path(f"{stem(chosen)}.urdf"), ".urdf")

    from antenna_pin.scenario.assemble import urdf_variant

    for written in urdf_variant(chosen).write(path, copy_meshes=copy_meshes):
        typer.echo(f"saved {written}")
    if chosen.closures:
        names = ", ".join(chosen.closures)
        typer.echo(f"note: a URDF is a tree; the closures of the scenario are not in it: {names}")
    if chosen.couplings:
        names = ", ".join(chosen.couplings)
        typer.echo(f"note: the couplings of the scenario are not in it: {names}")


def _is_urdf(target: str) -> bool:
    path = Path(target)
    return path.is_file() and path.suffix != ".toml"


def _check(
    targets: list[str], case: str | None, settings: list[str] | None, roots: list[Path], out: Path | None
) -> None:
    """Print a line for each finding, and a count of all."""
    from antenna_pin.base.files import check_writable, replacing

    target = None if out is None else check_writable(out)
    lines: list[str] = []
    count = loaded = 0

    def tell(line: str) -> None:
        lines.append(line)
        if target is None:
            say(line)

    for name in _files(targets):
        count += 1
        file = _is_urdf(name)
        if file and (case or settings):
            refuse(f"urdf: --case and --set are for scenarios only, and {name} is a URDF; leave them out")
        verdict, details = _verdict(name, file, case, settings, roots)
        loaded += verdict.startswith("loads")
        for line in (verdict, *details):
            tell(f"{name}: {line}")
    tell(f"{loaded} of {count} load")
    if target is not None:
        with replacing(target) as partial:
            partial.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        say(lines[-1])
        typer.echo(f"saved {target}")
    if loaded < count:
        raise typer.Exit(REFUSED)


def _files(targets: list[str]) -> Iterator[str]:
    """Yield the targets, in place of a folder the URDFs in it and below."""
    for target in targets:
        path = Path(target)
        if not path.is_dir():
            yield target
            continue
        files = sorted(file for file in path.rglob("*.urdf") if file.is_file())
        if not files:
            refuse(f"{target}: must be a folder with URDF files (*.urdf), got none")
        yield from map(str, files)


def _verdict(
    name: str, file: bool, case: str | None, settings: list[str] | None, roots: list[Path]
) -> tuple[str, list[str]]:
    """Return the verdict on a URDF, in words, and the details."""
    import warnings

    from antenna_pin.dynamics import System
    from antenna_pin.errors import AntennaPinError, NotSimulatedWarning
    from antenna_pin.mechanism import WrittenUrdf
    from antenna_pin.scenario.assemble import as_written, build_system, initial_state, urdf_variant

    details: list[str] = []
    try:
        if file or Path(name).suffix in _SUFFIXES:
            written = WrittenUrdf.load(name, package_path=roots)
            details = _passed_over(written)
            made = written.variant()
            system = System(_built(made))
            system.check_pose(system.neutral()[: system.model.nq], made.where)
        else:
            scenario = load(name, case, settings)
            written = as_written(scenario)
            details = _passed_over(written)
            made = urdf_variant(scenario)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", NotSimulatedWarning)  # it is said below
                system = build_system(scenario)
            initial_state(scenario, system)
    except AntennaPinError as error:
        return f"refused: {error}", details
    if made.unbounded:
        details.append(f"without bounds: {', '.join(made.unbounded)}")
    if made.points:
        details.append(f"point masses: {', '.join(made.points)}")
    if made.unlimited:
        joints = ", ".join(f"{name} ({bounds})" for name, bounds in made.unlimited)
        details.append(f"continuous, whatever bounds it states: {joints}")
    details += [f"inertia that no body has: {line}" for line in system.mechanism.impossible]
    details += [f"not drawn: {link}: {problem}" for link, problem in made.undrawn]
    if missing := _missing(made):
        details.append(f"not there: {', '.join(missing)}")
    details += [f"not simulated: {line.removeprefix(f'{made.where}: ')}" for line in made.not_simulated]
    freedoms = system.model.nv
    said = f"loads: {freedoms} freedom{'s' * (freedoms != 1)} on a {system.mechanism.base} base"
    if count := len(system.couplings):
        said += f", {count} coupled"
    return said, details


def _passed_over(written: WrittenUrdf) -> list[str]:
    return [f"passed over: {kind.text()}" for kind in written.passed_over]


def _built(variant: Urdf) -> Mechanism:
    """Return the mechanism on a free base, or a fixed one where that cannot be."""
    from antenna_pin.errors import MechanismError
    from antenna_pin.mechanism import WORLD, build_mechanism

    if variant.root == WORLD:
        return build_mechanism(variant, "fixed")
    try:
        return build_mechanism(variant, "free")
    except MechanismError as error:
        try:
            return build_mechanism(variant, "fixed")
        except MechanismError:
            raise error from None


def _missing(variant: Urdf) -> list[str]:
    """Return mesh files of shapes that are drawn and are not there, each once."""
    names = (
        visual.geometry.mesh.filename
        for link in variant.robot.links
        for visual in link.visuals
        if visual.geometry.mesh is not None
    )
    return [name for name in dict.fromkeys(map(str, names)) if variant.mesh_file(name) is None]
