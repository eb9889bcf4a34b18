"""What README.md and docs/ say is so: commands and their output, examples, reference tables, links.

A block that shows a file names it (```` ```python file=scripts/examples/x.py ````) and must equal it.
Commands in ```` ```console ```` blocks are run from top to bottom, in a folder where ``scripts`` is that of
the checkout, and what they print must agree but for what differs between machines; blocks marked ``slow``
are run by the slow tests. Reference tables stand between ``<!-- table: NAME -->`` and ``<!-- end -->``. To
bring all of them up to date::

    python tests/test_readme.py --write [--slow]
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import runpy
import shlex
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic.fields import FieldInfo
from typer.testing import CliRunner

from antenna_pin import load_scenario, simulate
from antenna_pin.cli import app
from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    NORMAL_LAWS,
    Parameter,
    is_elastic,
    law_parameters,
)
from antenna_pin.scenario import (
    ClearanceSpec,
    ConstantDrive,
    ContactClearance,
    InitialBaseSpec,
    InitialJointSpec,
    IntegratorSpec,
    JointSpec,
    LinkSpec,
    MaterialSpec,
    MechanismSpec,
    OrbitSpec,
    OutputSpec,
    PointingSpec,
    ScalesSpec,
    Scenario,
    ShapeSpec,
    SineDrive,
    SpringSpec,
    TableDrive,
)

ROOT = Path(__file__).parents[1]
DOCUMENTS = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
FENCE = re.compile(r"^```(\w*)(.*)\n((?:.*\n)*?)```$", re.MULTILINE)
TABLE = re.compile(r"(<!-- table: (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def documents(test: Callable[..., None]) -> Callable[..., None]:
    return pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)(test)


# --- blocks that show a file ---


def shown_file(info: str) -> Path | None:
    found = re.search(r"\bfile=(\S+)", info)
    return ROOT / found.group(1) if found else None


def with_files(text: str) -> str:
    """Return a document whose blocks hold what the files have that they show."""

    def fill(match: re.Match[str]) -> str:
        language, info, _ = match.groups()
        path = shown_file(info)
        return match.group() if path is None else f"```{language}{info}\n{path.read_text()}```"

    return FENCE.sub(fill, text)


@documents
def test_every_example_is_the_file_it_names(path):
    text = path.read_text()
    assert with_files(text) == text, "run: python tests/test_readme.py --write"
    for language, info, _ in FENCE.findall(text):
        assert language not in ("python", "toml", "xml") or shown_file(info), "an example must be a file"


def test_every_example_is_shown_and_run():
    text = "".join(path.read_text() for path in DOCUMENTS)
    for path in (ROOT / "scripts" / "examples").glob("*.py"):
        name = path.relative_to(ROOT).as_posix()
        assert f"file={name}" in text
        assert f"\n$ python {name}\n" in text


# --- commands and their output ---

# Of these the numbers are the machine's, or round-off. A limit that is exceeded fails the command; limits of
# time are for those who run it to judge, since tests run beside each other.
_TIMINGS = tuple(f"bench/{name}.py" for name in ("rhs", "run", "startup", "recording", "report"))
_OWN_NUMBERS = (
    *_TIMINGS,
    "bench/accuracy.py",
    "bench/bai2020.py",
    "bench/effective_mass.py",
    "random_scenarios.py",
)
_ROUND_OFF = (
    "wall time",
    "gross work",
    "error",
    "drift",
    "coal against",
    "ledger",
    "step halved",
    "steps",
    "evaluations",
)
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def commands(block: str) -> Iterator[tuple[str, str]]:
    """Yield the commands of a console block and the output shown."""
    for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, output = part.partition("\n")
        yield command, output


def run(command: str, folder: Path) -> tuple[str, int]:
    """Return what a command prints in a folder (both streams) and its exit code."""
    if not (folder / "scripts").exists():
        (folder / "scripts").symlink_to(ROOT / "scripts")
    words = shlex.split(command)
    before = Path.cwd()
    os.chdir(folder)
    try:
        if words[0] == "antenna-pin" and "|" not in words:
            result = CliRunner().invoke(app, words[1:], catch_exceptions=False)
            output, code = result.output, result.exit_code
        elif words[0] == "python" and words[1].startswith("scripts/examples/"):
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                runpy.run_path(words[1], run_name="__main__")
            output, code = stream.getvalue(), 0
        else:
            output, code = in_shell(command, folder)
    finally:
        os.chdir(before)
    lines = [line.rstrip() for line in output.splitlines()]
    return "".join(f"{line}\n" for line in lines if line), code


def in_shell(command: str, folder: Path) -> tuple[str, int]:
    """Return what a shell command prints and its exit code; ``python`` and ``antenna-pin`` are those here."""
    names = folder / "bin"
    names.mkdir(exist_ok=True)
    for name, call in (("python", ""), ("antenna-pin", "-m antenna_pin.cli ")):
        script = names / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {call}"$@"\n')
        script.chmod(0o755)
    path = f"{names}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command,
        shell=True,
        env=os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.stdout, done.returncode


def disagreement(command: str, shown: str, found: str) -> str:
    """Return the first line in which outputs differ by more than machines may, or ""."""
    own_numbers = any(name in command for name in _OWN_NUMBERS)
    right, left = found.splitlines(), shown.splitlines()
    if command == "antenna-pin list":  # models may be added
        return "" if set(left) <= set(right) else "a model or case is not there"
    for one, other in zip(left, right, strict=False):
        words, others = (" ".join(_NUMBER.sub("#", line).split()) for line in (one, other))
        if words != others and not set(words) == set(others) == {"─"}:
            return f"shown: {one}\nfound: {other}"
        if own_numbers or any(name in one for name in _ROUND_OFF):
            continue
        for a, b in zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True):
            # Single impacts are repeated to 1e-6 within 0.2 s; compilers may order sums otherwise.
            if abs(float(a) - float(b)) > 1e-3 * abs(float(a)):
                return f"shown: {one}\nfound: {other}"
    return "" if len(left) == len(right) else f"shown: {len(left)} lines\nfound: {len(right)} lines"


def is_slow(info: str) -> bool:
    return "slow" in info.split()


def check_commands(path: Path, folder: Path, slow: bool) -> None:
    problems = []
    for language, info, block in FENCE.findall(path.read_text()):
        if language != "console" or is_slow(info) != slow:
            continue
        for command, shown in commands(block):
            found, code = run(command, folder)
            if any(name in command for name in _TIMINGS):
                found, code = found.replace("  MISSED", ""), 0
            refused = shown.startswith("antenna-pin: ")
            if (code != 0) != refused:
                problems.append(f"$ {command}\nexit code {code}\n{found}")
            elif difference := disagreement(command, shown, found):
                problems.append(f"$ {command}\n{difference}")
    assert not problems, "\n\n".join([*problems, "to update: python tests/test_readme.py --write"])


@documents
def test_commands_print_what_is_shown(path, tmp_path):
    check_commands(path, tmp_path, slow=False)


@pytest.mark.slow
@documents
def test_slow_commands_print_what_is_shown(path, tmp_path):
    check_commands(path, tmp_path, slow=True)


# --- reference tables ---


def attribute_docs(cls: type) -> dict[str, str]:
    """Return what the docstrings of a class and of its bases say of its attributes."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        _, _, section = (base.__doc__ or "").partition("Attributes:\n")
        for entry in re.split(r"\n {4,8}(?=\w+: )", "\n" + section):
            name, _, text = entry.strip().partition(": ")
            if name.isidentifier():
                found[name] = " ".join(text.split("\n\n")[0].split())
    return found


def plain(text: str) -> str:
    """Return what a docstring says of an attribute as a table of keys and units has it."""
    text = re.sub(r"\s*(\[[^\]]*\]\s*(\(\[[^\]]*\]\))?)(?=[.;]|$)", "", text).replace("``", "`")
    for python, file in (
        ("None for ", "if left out, "),
        ("None if ", "left out if "),
        ("None where ", "left out where "),
        ("None to choose it", "if left out, it is chosen"),
    ):
        text = text.replace(python, file)
    text = text.strip(".; ")
    return text[:1].upper() + text[1:] if text.startswith(("if ", "left ")) else text


def annotations(item: Any) -> Iterator[Any]:
    """Yield what stands in an annotation, at any depth."""
    yield item
    for part in get_args(item):
        yield from annotations(part)


def kind_of(field: FieldInfo) -> str:
    """Return the unit of a field, or what else it holds."""
    for item in (*field.metadata, *annotations(field.annotation)):
        if type(item).__name__ in ("Quantity", "Vector"):
            units = item.unit if isinstance(item.unit, tuple) else (item.unit,)
            text = " or ".join("-" if unit == "1" else unit.replace("**", "^") for unit in units)
            sizes = getattr(item, "sizes", ())
            return f"{' or '.join(map(str, sizes))} × {text}" if sizes else text
    choices = [value for item in annotations(field.annotation) for value in get_args(item)]
    choices = [value for value in choices if isinstance(value, str)]
    if choices:
        return ", ".join(f"`{value}`" for value in choices)
    if str in annotations(field.annotation):
        return "list of text" if "tuple" in str(field.annotation) else "text"
    return "list of -" if "tuple" in str(field.annotation) else "-"


def default_of(field: FieldInfo) -> str:
    """Return the default of a field as a file would have it."""
    value = field.default
    if field.is_required():
        return "required"
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:g}"
    return f"`{json.dumps(value)}`" if value != "" else ""


def rows(cls: type[Any], names: Iterator[str] | None = None, required: str = "required") -> list[str]:
    """Return table rows for the keys of a scenario's table."""
    docs = attribute_docs(cls)
    lines = []
    for name in names or cls.model_fields:
        field = cls.model_fields[name]
        text = plain(docs[name]) or name.replace("_", " ")
        default = default_of(field)
        lines.append(
            f"| `{name}` | {kind_of(field)} | {required if default == 'required' else default} | {text} |"
        )
    return lines


def section(title: str, lines: list[str], note: str = "") -> str:
    head = ["| key | unit or value | default | meaning |", "|---|---|---|---|"]
    return "\n".join([f"**{title}**{note}", "", *head, *lines, ""])


def law_default(name: str, parameters: dict[str, Parameter]) -> str:
    """Return the default of a law's parameter, or where it comes from if a file leaves it out."""
    parameter = parameters[name]
    if parameter.default is not None:
        return f"{parameter.default:g}"
    if not parameter.from_joint:
        return "required"
    if name == "stiffness":
        given = "from materials and radii"
        return given if parameters["exponent"].default == 1.5 else f"required; {given} if exponent is 1.5"
    return {"modulus": "from materials", "effective_mass": "from the contact"}.get(name, "from the joint")


def normal_law_keys() -> list[str]:
    """Return the rows of the keys that a normal law has beside its parameters."""
    names = ", ".join(f"`{name}`" for name in DISSIPATIONS)
    elastic = ", ".join(f"`{name}`" for name in NORMAL_LAWS if is_elastic(name))
    return [
        "| any | `law` | a name below | required | Name of the law |",
        f"| {elastic} | `dissipation` | {names} | `none` | What dissipates beside an elastic law. Its"
        " parameters stand in the same table; they are those of the law of its name below, but for stiffness"
        " and exponent |",
    ]


def law_section(title: str, laws: Any, note: str, keys: list[str]) -> str:
    lines = list(keys)
    for law, cls in laws.items():
        parameters = law_parameters(cls)
        for name, parameter in parameters.items():
            unit = "-" if parameter.unit == "1" else parameter.unit.replace("**", "^")
            default = law_default(name, parameters)
            lines.append(f"| `{law}` | `{name}` | {unit} | {default} | {parameter.doc} |")
        if not parameters:
            lines.append(f"| `{law}` | | | | |")
    head = ["| law | parameter | unit | default | meaning |", "|---|---|---|---|---|"]
    return "\n".join([f"**{title}**{note}", "", *head, *lines, ""])


def clearance_rows() -> list[str]:
    """Return the rows of a clearance joint: what is required depends on the model."""
    classes = get_args(ClearanceSpec)
    meanings = []
    for cls in classes:
        names = " or ".join(f"`{name}`" for name in get_args(cls.model_fields["model"].annotation))
        meanings.append(f"{names}: {(cls.__doc__ or '').splitlines()[0].rstrip('.').replace('``', '`')}")
    choices = [name for cls in classes for name in get_args(cls.model_fields["model"].annotation)]
    listed = ", ".join(f"`{name}`" for name in choices)
    lines = [f"| `model` | {listed} | required | {'. '.join(meanings)} |"]
    laws = ("normal", "radial", "axial", "friction")
    for name in ContactClearance.model_fields:
        if name == "model" or name in laws:
            continue
        needing = [
            get_args(cls.model_fields["model"].annotation)[0]
            for cls in classes
            if cls.model_fields[name].is_required()
        ]
        lines += rows(ContactClearance, iter([name]), f"required for {', '.join(needing)}")
    return lines


def scenario_table() -> str:
    top = [name for name in Scenario.model_fields if name not in Scenario.carried]
    simple = [name for name in top if name in ("format", "title", "source", "duration")]
    drives = [
        line
        for kind, cls in (("constant", ConstantDrive), ("sine", SineDrive), ("table", TableDrive))
        for line in (
            row.replace("| `", f"| `{kind}`: `", 1)
            for row in rows(
                cls, iter(n for n in cls.model_fields if n not in ("joint", "axis", "motion", "kind"))
            )
        )
    ]
    drives = [
        "| `joint` | text | the drive's name | Name of the joint |",
        "| `kind` | `constant`, `sine`, `table` | required | What it is |",
        *rows(SineDrive, iter(["axis"])),
        *drives,
    ]
    drives = [
        line.replace(
            "| list of - | required |",
            f"| list of {'s' if '`time`' in line else 'N*m or N'} | unless `file` |",
        )
        if "table`: `t" in line
        else line
        for line in drives
    ]
    springs = ["| `joint` | text | the spring's name | Name of the joint |"]
    springs += rows(SpringSpec, iter(n for n in SpringSpec.model_fields if n not in ("joint", "motion")))
    joints = rows(InitialJointSpec, iter(n for n in InitialJointSpec.model_fields if n != "motion"))
    mechanism = [n for n in MechanismSpec.model_fields if n not in ("links", "joints")]
    integrator = [n for n in IntegratorSpec.model_fields if n != "scales"]
    parts = [
        section(
            "top of the file",
            [
                *rows(Scenario, iter(simple)),
                "| `default_case` | text | | The case that is run where none is named |",
            ],
        ),
        section("[mechanism]", rows(MechanismSpec, iter(mechanism))),
        section(
            "[mechanism.links.LINK]", rows(LinkSpec, iter(n for n in LinkSpec.model_fields if n != "shapes"))
        ),
        section("[mechanism.links.LINK.shapes.NAME]", rows(ShapeSpec), ": looks only"),
        section("[mechanism.joints.JOINT]", rows(JointSpec)),
        section("[materials.NAME]", rows(MaterialSpec), "; `steel` is known without"),
        section("[clearance.JOINT]", clearance_rows(), ": a revolute or continuous joint of the URDF"),
        law_section(
            "[clearance.JOINT.normal]",
            NORMAL_LAWS,
            ": the law of all its contacts; `[clearance.JOINT.radial]` and `[clearance.JOINT.axial]` change"
            " `law`, `dissipation` or parameters for the bore or the flanges",
            normal_law_keys(),
        ),
        law_section(
            "[clearance.JOINT.friction]",
            FRICTION_LAWS,
            ": `none` if left out",
            ["| any | `law` | a name below | required | Name of the law |"],
        ),
        section("[drives.NAME]", drives),
        section("[springs.NAME]", springs),
        section("[initial.joints.JOINT]", joints, ": zero where nothing is said"),
        section("[initial.base]", rows(InitialBaseSpec)),
        section("[integrator]", rows(IntegratorSpec, iter(integrator))),
        section("[integrator.scales]", rows(ScalesSpec)),
        section("[output]", rows(OutputSpec)),
        section(
            "[pointing]",
            rows(PointingSpec, iter(n for n in PointingSpec.model_fields if n != "orbit")),
            ": for analysis; the motion does not see it",
        ),
        section("[pointing.orbit]", rows(OrbitSpec), ": circular"),
        section(
            "[cases.NAME]",
            [
                "| `description` | text | | One line for `antenna-pin list` |",
                "| any other | | | Laid over the tables above; a table with `replace = true` replaces its"
                " like |",
            ],
        ),
    ]
    return "\n".join(parts)


def test_what_the_table_calls_required_cannot_be_left_out():
    """And what it says comes from elsewhere can: of every law, in a joint that has all else."""
    from antenna_pin.scenario.laws import law_spec, laws, missing_parameters

    for family, registry in (("normal", NORMAL_LAWS), ("friction", FRICTION_LAWS)):
        for law, cls in registry.items():
            parameters = law_parameters(cls)
            required = [name for name in parameters if law_default(name, parameters) == "required"]
            assert missing_parameters(law_spec(law, {}), laws(family)) == required, law


def test_the_table_misses_no_part_of_a_scenario():
    """Every table of a scenario is in the reference: a new one must be added to it."""
    known = {"mechanism", "materials", "clearance", "drives", "springs", "initial", "integrator", "output"}
    known |= {"pointing"}
    simple = {"format", "title", "source", "duration"}
    assert set(Scenario.model_fields) - Scenario.carried == known | simple
    assert len({frozenset(cls.model_fields) for cls in get_args(ClearanceSpec)}) == 1


def trajectory_table() -> str:
    overrides = ["springs.hinge={joint = 'azimuth', damping = 0.1}"]
    data = simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.03).data
    lines = ["| variable | dimensions | unit | meaning |", "|---|---|---|---|"]
    for names in (data.coords, data.data_vars):
        for name in names:
            variable = data[name]
            meaning = variable.attrs.get("long_name", "")
            if name in data.coords and not meaning:
                meaning = "names: " + ", ".join(f"`{label}`" for label in variable.values)
            if "flag_meanings" in variable.attrs:
                flags = zip(
                    variable.attrs["flag_values"], variable.attrs["flag_meanings"].split(), strict=True
                )
                meaning += ": " + ", ".join(f"{value} {text}" for value, text in flags)
            unit = variable.attrs.get("units", "")
            lines.append(f"| `{name}` | {', '.join(map(str, variable.dims))} | {unit} | {meaning} |")
    return "\n".join(lines).replace("|power|", "\\|power\\|") + "\n"


def layers_table() -> str:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (layers,) = (contract["layers"] for contract in contracts if contract["id"] == "layers")
    return "\n".join(["```text", *(layer.replace("(", "").replace(")", "") for layer in layers), "```", ""])


TABLES = {"scenario": scenario_table, "trajectory": trajectory_table, "layers": layers_table}


@documents
def test_reference_tables_are_up_to_date(path):
    for _, name, shown, _ in TABLE.findall(path.read_text()):
        assert shown.strip() == TABLES[name]().strip(), "run: python tests/test_readme.py --write"


def test_every_table_stands_somewhere():
    text = "".join(path.read_text() for path in DOCUMENTS)
    assert {name for _, name, _, _ in TABLE.findall(text)} == set(TABLES)


@documents
def test_links_lead_somewhere(path):
    text = FENCE.sub("", path.read_text())
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        assert re.match(r"https?://", target) or (path.parent / target).exists(), target


def test_pictures_are_small():
    for path in (ROOT / "docs" / "images").iterdir():
        assert path.stat().st_size < 300e3, path.name


# --- bringing the documents up to date ---


def write(slow: bool) -> None:
    for path in DOCUMENTS:
        text = with_files(path.read_text())
        text = TABLE.sub(lambda m: f"{m.group(1)}{TABLES[m.group(2)]()}{m.group(4)}", text)
        with tempfile.TemporaryDirectory() as folder:

            def fill(match: re.Match[str], folder: Path = Path(folder)) -> str:
                language, info, block = match.groups()
                if language != "console" or (is_slow(info) and not slow):
                    return match.group()
                done = "".join(f"$ {command}\n{run(command, folder)[0]}" for command, _ in commands(block))
                return f"```{language}{info}\n{done}```"

            path.write_text(FENCE.sub(fill, text))


if __name__ == "__main__":
    if "--write" not in sys.argv:
        sys.exit("usage: python tests/test_readme.py --write [--slow]")
    write("--slow" in sys.argv)
