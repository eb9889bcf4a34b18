"""The export of a scenario as an FMU."""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from antenna_pin.apps.fmu.packed import Packed, check_names
from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.errors import InvalidParameterError, MissingToolError
from antenna_pin.run.session import start
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import urdf_variant

_MODULE = '''"""{title}: one instance, in the form that pythonfmu3 loads."""

from pythonfmu3 import Fmi3Slave

from antenna_pin.apps.fmu.slave import Slave


class {name}(Slave, Fmi3Slave):
    """The scenario that is packed beside this file."""
'''
_NO_LETTER = re.compile(r"\W")


@takes()
def export_fmu(
    scenario: Scenario,
    out: str | os.PathLike[str],
    *,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    parameters: Sequence[str] = (),
) -> Path:
    """Write a scenario as an FMU for co-simulation (FMI 3.0); return the file.

    The scenario with all that it has read, its URDF and its meshes are in it. It runs where this package is
    installed for the Python that the tool loads; numbers are those of
    :class:`antenna_pin.run.session.Session`.

    Args:
        scenario: What to export.
        out: The file, NAME.fmu; replaced if it exists.
        inputs: What is commanded: drives by name, or numbers of elements by place.
        outputs: What can be read: numbers of a session by name.
        parameters: Places of numbers of the scenario that may be set before the start.

    Raises:
        AntennaPinError: A name that there is not; the scenario cannot be run.
        MissingToolError: pythonfmu3 is not installed.
        OutputError: The file cannot be written.
    """
    target = check_writable(out, ".fmu")
    if not outputs:
        raise InvalidParameterError("fmu", "outputs", "one name or more, such as hinge.angle", said="none")
    for kind, names, others in (
        ("inputs", inputs, ["time"]),
        ("outputs", outputs, [*inputs, "time"]),
        ("parameters", parameters, [*inputs, *outputs, "time"]),
    ):
        check_names(kind, names, others)
    builder = _builder()
    about = [scenario.model_dump_json(), list(inputs), list(outputs), list(parameters)]
    token = hashlib.sha256(json.dumps(about).encode()).hexdigest()[:32]
    packed = Packed(
        scenario=scenario,
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        parameters=tuple(parameters),
        token=token,
    )
    session = start(scenario, record=False)
    for check in (packed.inputs_of, packed.outputs_of, packed.parameters_of):
        check(session)
    name = _NO_LETTER.sub("_", f"{scenario.name}_{scenario.case or ''}".rstrip("_") or "scenario")
    name = name if name[0].isalpha() else f"_{name}"
    with tempfile.TemporaryDirectory(prefix="antenna_pin_") as folder:
        made = _build(Path(folder), name, packed, builder)
        with replacing(target) as partial:
            shutil.copyfile(made, partial)
    return target


def _builder() -> Any:
    try:
        return importlib.import_module("pythonfmu3.builder").FmuBuilder
    except ImportError:
        raise MissingToolError(
            "export fmu needs pythonfmu3; install it with pip install 'antenna-pin[fmu]'"
        ) from None


def _build(folder: Path, name: str, packed: Packed, builder: Any) -> Path:
    """Return the FMU, made in a folder."""
    module = f"{name}_{packed.token[:12]}"  # of two FMUs in one process each has its own
    script = folder / f"{module}.py"
    script.write_text(_MODULE.format(title=name, name=name), encoding="utf-8")
    packed.write(folder)
    mechanism = folder / "mechanism"
    mechanism.mkdir()
    urdf_variant(packed.scenario).write(
        mechanism / Path(packed.scenario.mechanism.urdf).name, copy_meshes=True
    )
    path = list(sys.path)
    try:
        made: Path = builder.build_FMU(
            script, dest=folder / "made", project_files=[folder / "antenna_pin.json", mechanism]
        )
    finally:
        sys.path[:] = path
    return made
