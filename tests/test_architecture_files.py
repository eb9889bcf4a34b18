"""Every file is one concept: none is long, and no two need each other."""

import ast
import importlib
import sys
from pathlib import Path

import grimp
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import antenna_pin

PACKAGE = Path(antenna_pin.__file__).parent

LONGEST = 600
"""Lines of a file at which it holds a second concept."""


def test_no_file_is_long():
    long = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if len(path.read_text().splitlines()) > LONGEST
    }
    assert not long


def circles(imports):
    """Return the groups of modules that import one another, by way of others or not, sorted."""
    modules = sorted(imports)
    place = {name: number for number, name in enumerate(modules)}
    pairs = np.array([(place[a], place[b]) for a in modules for b in imports[a]]).reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(modules),) * 2)
    count, label = connected_components(graph, directed=True, connection="strong")
    groups = [tuple(modules[k] for k in np.flatnonzero(label == number)) for number in range(count)]
    return {group for group in groups if len(group) > 1}


def test_no_files_import_one_another():
    """Imports for types and those within functions count: they tie two files together just the same."""
    graph = grimp.build_graph("antenna_pin", exclude_type_checking_imports=False, cache_dir=None)
    found = circles({name: graph.find_modules_directly_imported_by(name) for name in graph.modules})
    assert not found


def test_a_circle_is_found_however_long():
    imports = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": set(), "e": {"a"}}
    assert circles(imports) == {("a", "b", "c")}


def rooms_of_others(imports):
    """Return the pairs of a module and what it imports of another room under a private name."""
    return {
        (name, other)
        for name, others in imports.items()
        for other in others
        if other.count(".") > 1
        and other.rsplit(".", 1)[-1].startswith("_")
        and name.split(".")[1] != other.split(".")[1]
    }


def test_a_rooms_private_modules_are_its_own():
    graph = grimp.build_graph("antenna_pin", cache_dir=None)
    assert not rooms_of_others(
        {name: graph.find_modules_directly_imported_by(name) for name in graph.modules - {"antenna_pin"}}
    )


def test_compiled_code_knows_numpy_numba_and_records():
    """So that it can be compiled, read and called without what only sets it up: a URDF, a schema, a table."""
    graph = grimp.build_graph("antenna_pin", include_external_packages=True, cache_dir=None)
    below = {
        "antenna_pin.compiled.decorators",
        "antenna_pin.compiled.by_address",
        "antenna_pin.compiled.calls",
        "antenna_pin.compiled.lanes",
        "antenna_pin.base.records",
        "antenna_pin.contact.records",
        "antenna_pin.contact.registry",  # from which the chains of kinds are made
        "antenna_pin.elements.element",  # of which the records of elements are derived
        "antenna_pin.elements.registry",  # from which the chain of kinds is made
        "numba",
        "numpy",
    }
    kernels = {name for name in graph.modules if name.endswith("kernels")}
    known = {(name, other) for name in kernels for other in graph.find_modules_directly_imported_by(name)}
    assert not {pair for pair in known if pair[1] not in below | kernels | sys.stdlib_module_names}


ARGUMENTS = 7
"""Arguments of a compiled function beyond which some of them belong together, in a record."""

TOO_MANY = {
    "dynamics/constraints/loaded_kernels.py: accelerate": 9,
    "dynamics/inspect_kernels.py: inspect_step": 9,
    "dynamics/trial_kernels.py: root_of": 8,
    "run/engine/episode_kernels.py: keep_peaks": 8,
    "run/engine/implicit_kernels.py: attempt_implicit": 10,
    "run/engine/step_kernels.py: attempt": 8,
    "run/engine/step_kernels.py: prepare_dense": 8,
    "run/engine/watch_kernels.py: may_happen": 9,
    "integrate/kernels.py: dense_joint": 8,
    "integrate/newton_kernels.py: estimate": 8,
    "integrate/radau_kernels.py: _set_out": 8,
    "integrate/radau_kernels.py: go_on": 8,
    "joints/kernels.py: alone": 10,
    "joints/kernels.py: clearance_joint": 10,
    "joints/kernels.py: contact_forces": 8,
    "joints/row_kernels.py: bristles": 8,
}
"""Functions that still have more, and how many: a list that gets shorter only."""


def compiled_code():
    """Yield the path of each file of kernels, in the package, and its code."""
    for path in sorted(PACKAGE.rglob("*kernels.py")):
        yield path.relative_to(PACKAGE).as_posix(), ast.parse(path.read_text())


def test_kernels_take_few_arguments():
    """Beyond seven a call can no longer be read, and what travels together has no name."""
    counts = {
        f"{file}: {one.name}": sum(
            a.arg != "self" for a in one.args.posonlyargs + one.args.args + one.args.kwonlyargs
        )
        for file, code in compiled_code()
        for one in ast.walk(code)
        if isinstance(one, ast.FunctionDef)
    }
    assert {name: count for name, count in counts.items() if count > ARGUMENTS} == TOO_MANY


def test_what_kernels_take_has_types():
    """An ``Any`` hides a misspelt field, and that a room knows one above it."""
    counts, fields = {}, []
    for file, code in compiled_code():
        for one in ast.walk(code):
            if isinstance(one, ast.FunctionDef):
                every = [*one.args.posonlyargs, *one.args.args, one.args.vararg, *one.args.kwonlyargs]
                taken = [ast.unparse(a.annotation or ast.Name("Any")) for a in every if a and a.arg != "self"]
                counts[f"{file}: {one.name}"] = taken.count("Any")
            if isinstance(one, ast.ClassDef):
                own = (field for field in one.body if isinstance(field, ast.AnnAssign))
                fields += [f"{file}: {one.name}" for field in own if ast.unparse(field.annotation) == "Any"]
    assert not {name: count for name, count in counts.items() if count}
    assert not fields


def test_a_constant_of_compiled_code_has_one_value():
    """One name with two values is read as one: the kinds of joints were numbered in three ways."""
    values = {}
    for file, code in compiled_code():
        module = importlib.import_module(f"antenna_pin.{file.removesuffix('.py').replace('/', '.')}")
        for one in code.body:
            targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
            for target in targets:
                value = getattr(module, getattr(target, "id", ""), None)
                if isinstance(value, int | float | np.number):
                    values.setdefault(target.id, set()).add(float(value))
    assert {name for name, found in values.items() if len(found) > 1} == {"GAP"}
