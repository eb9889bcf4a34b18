"""``antenna-pin contact``: laws by name, forces, certificates, the experiment; refusals in one line."""

import re
import subprocess
import sys

import pytest

from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    MATERIALS,
    NORMAL_LAWS,
    is_elastic,
    law_parameters,
)

ELASTIC = [name for name in NORMAL_LAWS if is_elastic(name)]
TAKING = [name for name, law in DISSIPATIONS.items() if "restitution" in law_parameters(law)]


@pytest.fixture
def contact(cli, printed):
    """Return a function: the output of a command on contact laws."""

    def run(*arguments):
        out = printed(cli("contact", *arguments))
        assert all(line == line.rstrip() for line in out.splitlines())
        return out

    return run


def row(text, *start):
    """Return the cells of the first row of a table that starts with these."""
    for line in text.splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if cells[: len(start)] == list(start):
            return cells
    raise AssertionError(f"no row {start} in\n{text}")


# --- list ---


def test_every_law_is_listed_once_in_its_family_without_markup(contact):
    text = contact("list")
    names = [line.split()[0] for line in text.splitlines() if re.match(r" [a-z]", line)]
    names = [name for name in names if name != "name"]
    whole = [name for name in NORMAL_LAWS if not is_elastic(name)]
    assert names == [*ELASTIC, *whole, *DISSIPATIONS, *FRICTION_LAWS, *MATERIALS]
    assert not re.search(r"\\|:\w+:|`", text)


def test_parameters_have_units_and_defaults(contact):
    assert row(contact("list"), "lankarani-nikravesh")[2] == (
        "stiffness* [N/m^exponent], restitution [-], exponent = 1.5 [-]"
    )
    assert "F = pi/4 E* L depth" in row(contact("list"), "liu-2013-hertz")[1]


# --- curve ---


def test_bais_joint_at_four_depths(contact):
    text = contact("curve")
    assert [
        line.split()[0] for line in text.splitlines() if line.split()[:1] and line.split()[0] in ELASTIC
    ] == (ELASTIC)
    law = NORMAL_LAWS["liu-2013-hertz"](
        length=0.05, journal_radius=0.0098, bearing_radius=0.01, modulus=207e9 / 2.0 / 0.91
    )
    cells = row(text, "liu-2013-hertz")[1:5]
    for cell, depth in zip(cells, (1e-7, 1e-6, 5e-6, 2e-5), strict=True):
        # Four digits are printed.
        assert float(cell) == pytest.approx(law.elastic_force(depth), rel=5e-4)
    assert "at 0.1 um the laws differ by" in text


def test_a_unit_at_the_end_of_a_list_counts_for_all_and_numbers_are_si(contact):
    wanted = contact("curve", "johnson", "--depths", "1 um, 2 um")
    assert contact("curve", "johnson", "--depths", "1,2um") == wanted
    assert contact("curve", "johnson", "--depths", "1000 nm, 0.002 mm") == wanted
    assert contact("curve", "johnson", "--depths", "1e-6,2e-6", "--length", "0.05") == wanted


def test_beyond_its_range_a_law_has_no_force(contact):
    assert row(contact("curve", "hertz-line", "--depths", "50um,60um"), "hertz-line")[2] == "-"


def test_a_figure_is_written_and_named(contact, tmp_path):
    out = tmp_path / "figures"
    text = contact("curve", "johnson", "hertz", "--out", out, "--format", "png,pdf")
    assert sorted(path.name for path in out.iterdir()) == ["force_curves.pdf", "force_curves.png"]
    assert f"{out / 'force_curves.png'}" in text


# --- restitution ---


def test_closed_forms_and_impacts_agree(contact):
    text = contact("restitution", "exact-restitution", "gonthier", "tsuji", "--asked", "0.3,0.9")
    assert row(text, "exact-restitution", "0.3")[2:5] == ["0.3000000"] * 3
    for name in ("gonthier", "tsuji"):
        closed, wall, pair = row(text, name, "0.9")[2:5]
        assert float(closed) == pytest.approx(float(wall), abs=2e-7)  # seven digits are printed
        assert float(closed) == pytest.approx(float(pair), abs=2e-7)
    found = re.search(r"largest errors: (\S+) in restitution, (\S+) of the peak depth", text)
    assert max(map(float, found.groups())) <= 1e-6


def test_without_simulation_there_are_closed_forms_of_all_that_take_a_restitution(contact, tmp_path):
    text = contact("restitution", "--no-simulate", "--asked", "0.5", "--out", tmp_path)
    for name in TAKING:
        assert row(text, name, "0.5")[3:5] == ["-", "-"]
    assert "largest errors" not in text
    assert (tmp_path / "restitution.png").exists()


# --- experiment ---


def test_experiment_prints_the_errors_of_the_paper_and_of_every_law(contact):
    text = contact("experiment")
    assert "misprint: 2.312" in row(text, "6", "0.094")[-1]
    assert row(text, "printed: Hertz")[-3:] == ["55.2", "105.4", "11 of 11"]
    assert row(text, "printed: conformal")[-3:] == ["31.8", "61.2", "11 of 11"]
    assert row(text, "liu-2013", "1")[-3:-1] == ["21.3", "47.2"]
    assert row(text, "liu-2013-corrected", "1")[2:] == ["6.0", "9.7", "31.1", "14.2", "41.4", "11 of 11"]
    for name in ELASTIC:
        assert row(text, name, "1") and row(text, name, "2")
    assert "What the data cannot decide" in text
    # The rows that the text names are those with the remark.
    off = [line.split()[0] for line in text.splitlines() if "(14) off by" in line]
    assert f"but for rows {', '.join(off)}, which are off" in " ".join(text.split()) and len(off) == 3
    assert "Row 6 does not fit" in " ".join(text.split())


def test_experiment_draws_the_figures_of_the_paper(contact, tmp_path):
    contact("experiment", "--out", tmp_path, "--width", "column")
    assert sorted(path.stem for path in tmp_path.iterdir()) == [f"liu2013_figure{n}" for n in (3, 5, 6)]


# --- scenarios ---


def test_scenarios_of_rigid_parts_and_of_parts_that_penetrate(contact):
    rigid = contact("scenarios")
    assert "9 of 16 are possible" in rigid
    assert "12 of 16 are possible" in contact("scenarios", "--penetration", "50 um")
    assert row(rigid, "line", "one point")[2] == "-"


# --- refusals ---


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("curve", "jonson"), r"elastic law 'jonson' is unknown; did you mean johnson\? known: bai"),
        (("curve", "flores"), r"an elastic one of hertz,.*got 'flores'"),
        (("curve", "--material", "stel"), r"did you mean steel\?"),
        (("curve", "--depths", "1 N"), r"--depths must be a length \[m\], got '1 N' \(force\)"),
        (("curve", "--depths=-1um"), "--depths must be positive"),
        (("curve", "--depths", ","), "--depths must be one value or more"),
        (("curve", "--radial-clearance", "10 mm"), "must be below the bearing's radius, 10 mm"),
        (("curve", "--length", "0"), "--length must be positive"),
        (("curve", "--format", "gif"), "known: pdf, png, svg"),
        (("restitution", "florez"), r"did you mean flores\?"),
        (("restitution", "kelvin-voigt"), "one that takes a restitution: lankarani"),
        (("restitution", "--asked", "1.2"), r"--asked must be in \[0, 1\], got 1.2"),
        (("restitution", "--mass", "1 m"), r"--mass must be a mass \[kg\]"),
        (("experiment", "--journal-radius", "nan"), "--journal-radius"),
        (("experiment", "--out", __file__), "this is a file; name a folder"),
        (("scenarios", "--flange-radius", "9 mm"), "flange_radius must be above"),
    ],
)
def test_refusals_are_one_line_with_a_way_out(cli, refused, arguments, said):
    assert re.search(said, refused(cli("contact", *arguments)))


def test_help_does_not_wait_for_the_laws():
    script = (
        "import sys, antenna_pin.apps.cli;"
        "print(sorted({'numba', 'numpy', 'matplotlib', 'pint', 'rich.table'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
