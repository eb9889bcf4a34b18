"""The plan of the house, checked: who imports whom, and that every room shows what it says it does."""

import ast
import importlib
import pkgutil
import re
import tomllib
from pathlib import Path

import grimp
import pytest
from importlinter import api as importlinter_api
from importlinter.application import use_cases

import antenna_pin
from antenna_pin.compiled import jit

ROOT = Path(__file__).parents[1]
PYPROJECT = ROOT / "pyproject.toml"


def test_import_contracts_are_kept(monkeypatch):
    monkeypatch.chdir(ROOT)
    assert importlinter_api.read_configuration(str(PYPROJECT))["contracts_options"]
    assert use_cases.lint_imports(config_filename=str(PYPROJECT), cache_dir=None), "run: lint-imports"


@pytest.fixture(scope="module")
def graph():
    return grimp.build_graph(
        "antenna_pin", include_external_packages=True, exclude_type_checking_imports=True, cache_dir=None
    )


@pytest.mark.parametrize(
    ("package", "rooms"),
    [
        ("matplotlib", {"show.plot"}),
        ("meshcat", {"show.record"}),
        ("selenium", {"show.record"}),
        ("av", {"show.record"}),
        (
            "pinocchio",
            {
                "mechanism",
                "joints",
                "dynamics",
                "scenario.assemble",
                "run.simulation",
                "studies.linear",
                "studies.nonlinear",
                "studies.statics",
            },
        ),
        ("coal", {"joints.geometry", "joints"}),
        ("yourdfpy", {"mechanism"}),
        ("typer", {"apps.cli"}),
        ("rich", {"apps.cli"}),
        ("pint", {"base"}),
        ("jinja2", {"show.report", "apps.live"}),
        ("markupsafe", {"show.report"}),
        ("pythonfmu3", {"apps.fmu"}),
        ("bokeh", {"apps.live"}),
        ("fmpy", set()),
    ],
)
def test_a_library_is_known_to_its_rooms_only(graph, package, rooms):
    if package not in graph.modules:
        return  # nobody imports it yet
    importers = graph.find_modules_that_directly_import(package)
    assert not [
        one for one in importers if not f"{one}.".startswith(tuple(f"antenna_pin.{r}." for r in rooms))
    ]


def packages():
    """Return all modules that others import by a public name."""
    found = ["antenna_pin"]
    for module in pkgutil.walk_packages(antenna_pin.__path__, "antenna_pin."):
        if not any(part.startswith("_") for part in module.name.split(".")):
            found.append(module.name)
    return found


def test_every_public_name_can_be_imported():
    for name in packages():
        module = importlib.import_module(name)
        names = list(getattr(module, "__all__", []))
        assert len(names) == len(set(names)), f"{name}: a name stands twice in __all__"
        missing = [public for public in names if not hasattr(module, public)]
        assert not missing, name
        if hasattr(module, "__path__") and name != "antenna_pin.compiled":
            assert names, f"{name} is a package: it re-exports its public names in __all__"


def test_constraints_pin_every_dependency():
    """An exact version for each direct dependency and each tool, and nothing but exact versions."""
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pinned = {}
    for line in lines:
        if not line or line.startswith("#"):
            continue
        name, version = line.split("==")  # nothing but exact versions
        assert version[0].isdigit()
        pinned[name.lower().replace("_", "-")] = version
    project = tomllib.loads(PYPROJECT.read_text())["project"]
    wanted = project["dependencies"] + sum(project["optional-dependencies"].values(), [])
    for requirement in wanted:
        if requirement.startswith(f"{project['name']}["):
            continue  # another extra of this package
        name = requirement.split(">=")[0].strip().lower().replace("_", "-")
        assert name in pinned


_MAKERS = {"inlined", "kernel", "released", "deferred"}


def used_by_kernels(tree):
    """Return the names that kernels of a module use, with those that they are defined by at its top."""
    own = {}
    for node in tree.body:
        names = [one.id for one in ast.walk(node) if isinstance(one, ast.Name)]
        if isinstance(node, ast.FunctionDef):
            decorators = {getattr(one, "id", "") for one in node.decorator_list}
            node.returns = None
            for one in node.args.args:
                one.annotation = None
            own[node.name] = {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
            if decorators & _MAKERS:
                own.setdefault("", set()).update(own[node.name])
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            for name in names:
                own.setdefault(name, set()).update(names)
    found, left = set(), own.get("", set())
    while left:
        found |= left
        left = set().union(*(own.get(name, set()) for name in left)) - found
    return found


def test_everything_that_is_compiled_stands_under_the_stamp():
    """A kernel's constants come from files that the cache is tied to, or a stale kernel would run."""
    folder = ROOT / "antenna_pin"
    stamped = set(jit.stamped_files())
    for path in folder.rglob("*.py"):
        text = path.read_text()
        if re.search(r"decorators import .*\b(deferred|inlined|kernel)\b", text):
            assert path in stamped or path.name == "decorators.py", path
    for path in stamped:
        tree = ast.parse(path.read_text())
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        # Beside a class there are imports that no kernel uses.
        used = None if path.name.endswith("kernels.py") else used_by_kernels(tree)
        for node in imports:
            if not (node.module or "").startswith("antenna_pin"):
                continue
            source = folder.joinpath(*node.module.split(".")[1:])
            for name in node.names:
                if used is not None and (name.asname or name.name) not in used:
                    continue
                # A module, or a file that holds a constant or a function.
                files = {source.with_suffix(".py"), source / f"{name.name}.py", source / "__init__.py"}
                # Kernels of kinds are found by their number when called.
                is_free = source.name == "decorators" or name.name == "registry"
                assert files & stamped or is_free, (path, node.module, name.name)


def test_what_kernels_use_is_found_through_constants_of_their_file():
    tree = ast.parse("from x import a, b, c\nd = a + 1\n@inlined\ndef f(x):\n    return d * b\ndef g(): c")
    assert {"a", "b", "d"} <= used_by_kernels(tree) and "c" not in used_by_kernels(tree)
