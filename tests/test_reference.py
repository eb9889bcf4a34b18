"""The reference tables in README.md and docs/ are what the code says, and miss nothing."""

import importlib
import re
from pathlib import Path

import pytest

from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, law_parameters
from antenna_pin.scenario import FAMILY_SPECS, Scenario
from antenna_pin.scenario.clearance import CLEARANCES
from antenna_pin.scenario.laws import law_spec, laws, missing_parameters

SCRIPTS = Path(__file__).parents[1] / "scripts" / "pages"


@pytest.fixture
def reference(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return importlib.import_module("reference")


def test_every_table_is_up_to_date(reference):
    for path in reference.documents():
        text = path.read_text()
        assert reference.filled(text) == text, f"{path.name}: run python scripts/pages/reference.py --write"


def test_every_table_stands_in_one_place(reference):
    names = [name for path in reference.documents() for name in reference.names_of_tables(path.read_text())]
    assert sorted(names) == sorted(reference.TABLES)


def test_check_and_write_name_what_is_out_of_date(reference, monkeypatch, tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("above\n<!-- table: layers -->\nof old\n<!-- end -->\nbelow\n")
    monkeypatch.setattr(reference, "ROOT", tmp_path)
    monkeypatch.setattr(reference, "documents", lambda: [page])
    monkeypatch.setattr(reference, "TABLES", {"layers": lambda: "of today\n"})
    for option, code, text in (
        ("--check", 1, "of old"),
        ("--write", 0, "of today"),
        ("--check", 0, "of today"),
    ):
        monkeypatch.setattr("sys.argv", ["reference.py", option])
        assert reference.main() == code
        assert page.read_text() == f"above\n<!-- table: layers -->\n{text}\n<!-- end -->\nbelow\n"
    said = capsys.readouterr().out.splitlines()
    assert said == ["page.md: out of date; bring it up to date with --write", "page.md: written"]


@pytest.mark.parametrize(
    "registry", [NORMAL_LAWS, DISSIPATIONS, FRICTION_LAWS], ids=["normal", "loss", "friction"]
)
def test_every_law_says_its_formula_and_whose_it_is(reference, registry):
    """A law as a whole says it by its parts."""
    formulas = importlib.import_module("formulas")
    for name, cls in registry.items():
        if name in formulas.NOTHING:
            continue
        for part in (cls.elastic, cls.dissipation) if hasattr(cls, "elastic") else (cls,):
            assert formulas.has_formula(part), f"{part.__name__}: no formula in its docstring"
            assert formulas.source_of(part), f"{part.__name__}: no source (References) in its docstring"


def test_no_markup_of_docstrings_is_left_among_the_formulas(reference):
    """Each is drawn: dollars in pairs, no role, no directive."""
    table = reference.TABLES["formulas"]()
    assert not re.search(r":\w+:`|\.\. math::|``", table)
    assert table.count("$$") % 2 == 0 and table.replace("$$", "").count("$") % 2 == 0


def test_what_the_table_calls_required_cannot_be_left_out(reference):
    """And what it says comes from elsewhere can: of every law, in a joint that has all else."""
    law_default = importlib.import_module("formulas").law_default
    for family, registry in (("normal", NORMAL_LAWS), ("friction", FRICTION_LAWS)):
        for law, cls in registry.items():
            parameters = law_parameters(cls)
            required = [name for name in parameters if law_default(name, parameters) == "required"]
            assert missing_parameters(law_spec(law, {}), laws(family)) == required, law


def test_the_tables_miss_no_part_of_a_scenario(reference):
    """Every table of a scenario has its line in the overview and a head on a page, every key a row there."""
    overview = reference.TABLES["scenario"]()
    pages = "".join(table() for name, table in reference.TABLES.items() if name.startswith("scenario_"))
    for name in set(Scenario.model_fields) - Scenario.carried:
        table = re.search(rf"`\[{name}[.\]]", overview)
        assert table or f"`{name}`" in pages, name
    for heading in re.findall(r"^## (.*)$", pages, re.MULTILINE):
        assert f"`{heading}`" in overview or f"[{heading}]" in overview, heading
    for family, specs in FAMILY_SPECS.items():
        for kind, cls in specs.items():
            for key in cls.model_fields:
                assert f"`{key}`" in pages, f"{key} of {kind} of {family}"
    assert len({frozenset(cls.model_fields) for cls in CLEARANCES.values()}) == 1
