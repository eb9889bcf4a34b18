"""The counts in docs/contact-scenarios.md are what the code returns.

They stand between ``<!-- scenarios: counts -->`` and ``<!-- end -->``. To bring them up to date::

    python tests/analysis/test_contact_scenarios_page.py
"""

import re
from pathlib import Path

from antenna_pin import build_system, load_scenario
from antenna_pin.analysis import possible_scenarios

PAGE = Path(__file__).parents[2] / "docs" / "contact-scenarios.md"
TABLE = re.compile(r"(<!-- scenarios: counts -->\n)(.*?)(<!-- end -->)", re.DOTALL)
DEPTHS = (0.0, 1e-7, 1e-6, 1e-5, 1e-4)


def shape(case):
    overrides = ["clearance.elevation.axial_clearance=50 um"] if case == "50um" else []
    scenario = load_scenario("bai2020", case="case3" if overrides else case, overrides=overrides)
    return build_system(scenario).clearances[0].geometry


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def counts():
    header = ["case", "C_a [um]", "rigid", *(f"{1e6 * depth:g} um" for depth in DEPTHS[1:])]
    rows = []
    for case in ("case2-contact", "case3", "case4", "case5", "50um"):
        joint = shape(case)
        found = [sum(pair.possible for pair in possible_scenarios(joint, depth)) for depth in DEPTHS]
        name = "(not shipped)" if case == "50um" else case
        rows.append([name, f"{1e6 * joint.axial_clearance:.0f}", *map(str, found)])
    return table(header, rows)


def filled(text):
    """Return the page with its table as the code has it."""
    return TABLE.sub(lambda match: match.group(1) + counts() + match.group(3), text)


def test_the_table_of_the_page_is_up_to_date():
    text = PAGE.read_text()
    assert len(TABLE.findall(text)) == 1
    assert filled(text) == text, f"run: python {Path(__file__).name}"


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text()))
