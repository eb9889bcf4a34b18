"""Every file is one concept: none is long, and no two need each other."""

import sys
from pathlib import Path

import grimp
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import antenna_pin

PACKAGE = Path(antenna_pin.__file__).parent

LONGEST = 350
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
        "antenna_pin._compile",
        "antenna_pin._called",
        "antenna_pin._lanes",
        "antenna_pin.records",
        "antenna_pin.contact.records",
        "antenna_pin.elements.registry",  # from which the chain of kinds is made
        "numba",
        "numpy",
    }
    kernels = {name for name in graph.modules if name.endswith("kernels")}
    known = {(name, other) for name in kernels for other in graph.find_modules_directly_imported_by(name)}
    assert not {pair for pair in known if pair[1] not in below | kernels | sys.stdlib_module_names}
