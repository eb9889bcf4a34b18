"""Results show themselves: figures, recordings, reports and numbers as their own, and cards."""

import importlib
import inspect
import json
import re
from html.parser import HTMLParser

import pytest

import antenna_pin
from antenna_pin import build_system, laws, load_scenario, load_study, simulate
from antenna_pin.analysis import numbers_of
from antenna_pin.base import views as _views
from antenna_pin.errors import InvalidParameterError, OutputError, UnknownNameError
from antenna_pin.show.plot import CATALOGUE
from antenna_pin.studies.linear import modes


@pytest.fixture(scope="module")
def pair():
    return [
        simulate(load_scenario("bai2020", case=case, overrides={"integrator.engine": "compiled",
                 "clearance.elevation.geometry": "closed-form"} if case == "case3" else {}), duration=0.02)
        for case in ("case1", "case3")
    ]  # fmt: skip


def test_every_view_of_the_table_is_there_and_bound():
    """A name of the table that nothing answers to would be found by a user only."""
    for name, home in _views.VIEWS.items():
        file, _, function = home.partition(".")
        made = getattr(importlib.import_module(f"antenna_pin.show.views.{file}"), function)
        assert inspect.getdoc(made), name


def test_figures_by_name_are_those_of_the_catalogue(pair):
    ideal, run = pair
    assert set(dir(run.plot)) <= set(CATALOGUE)
    assert "contact_forces" in dir(run.plot)
    assert "contact_forces" not in dir(ideal.plot)
    by_call, by_name = run.plot("contact_forces"), run.plot.contact_forces()
    assert len(by_call.axes) == len(by_name.axes) > 0
    lines = run.plot("motion_acceleration", beside=ideal).axes[0].get_lines()
    assert len(lines) > len(run.plot("motion_acceleration").axes[0].get_lines())


def test_a_figure_that_there_is_not_is_refused_with_those_that_there_are(pair):
    ideal, run = pair
    with pytest.raises(UnknownNameError, match="did you mean contact_forces"):
        run.plot("contact_force")
    with pytest.raises(AttributeError, match="did you mean contact_forces"):
        _ = run.plot.contact_force
    with pytest.raises(InvalidParameterError, match=r"contact_forces must be .*this run has .*motion_angle"):
        ideal.plot("contact_forces")
    with pytest.raises(InvalidParameterError, match="beside must be runs"):
        run.plot("contact_forces", beside=3)
    with pytest.raises(OutputError, match=r"must end in \.html"):
        run.record("run.avi")
    for write in (run.report, run.report(figures=False, recordings=False).save, run.record().save):
        with pytest.raises(OutputError, match=r"must end in \.html; try x\.html, which a browser prints"):
            write("x.pdf")
    with pytest.raises(OutputError, match=r"must end in \.nc; try x\.nc"):
        run.save("x.csv")


def test_the_numbers_are_those_of_the_command(pair):
    ideal, run = pair
    assert json.dumps(run.analyse(ideal)) == json.dumps(numbers_of(run, ideal))
    assert run.analyse.impacts().sizes["impact"] == run.data.sizes["episode"]
    assert run.analyse.frame("loads")["peak_force"].max() == run.data["peak_force"].values.max()
    with pytest.raises(AttributeError, match="did you mean impacts"):
        _ = run.analyse.impact


def test_a_recording_and_a_report_are_written_and_returned(pair, tmp_path):
    ideal, run = pair
    made = run.record(tmp_path / "run.html", ideal=ideal)
    assert (tmp_path / "run.html").read_text(encoding="utf-8") == made.html
    page = run.report(tmp_path / "r.html", beside=ideal, figures=False, recordings=False)
    assert (tmp_path / "r.html").read_text(encoding="utf-8") == page.html


def test_what_has_not_been_run_says_so(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match="run_study"):
        load_study("bai2020/tolerances").plot()


class _Tree(HTMLParser):
    """Fails where an element is not closed in order."""

    def __init__(self):
        super().__init__()
        self.stack, self.exact = [], []

    def handle_starttag(self, tag, attrs):
        self.stack.append(tag)
        self.exact += [float(value) for name, value in attrs if name == "title"]

    def handle_endtag(self, tag):
        assert self.stack.pop() == tag


def cards(pair):
    yield "run", pair[1]
    yield "ideal", pair[0]
    yield "scenario", load_scenario("solar_array")
    yield "study", load_study("bai2020/tolerances")
    yield "modes", modes(load_scenario("bai2020", case="flexible"))
    for name in ("solar_array", "chen2021", "slider_crank", "reaction_wheel"):
        yield f"system {name}", build_system(load_scenario(name))


def test_cards_are_well_formed_small_and_run_no_scripts(pair):
    for name, one in cards(pair):
        html = one._repr_html_()
        tree = _Tree()
        tree.feed(html)
        assert tree.stack == [], name
        assert len(html.encode()) < 30_000, name
        assert "<script" not in html and "http" not in html.replace("http://www.w3.org/2000/svg", ""), name


def test_a_system_says_what_acts_on_what_and_names_its_coordinates():
    system = build_system(load_scenario("solar_array"))
    html = system._repr_html_()
    for family in ("joints", "springs", "stops", "latches", "gears"):
        assert f"<dt>{family}</dt>" in html, family
    assert "root, first, second, third (with play, RevoluteClearance)" in html
    assert ", ".join(system.names_q[system.mechanism.joint("first").q]) in html
    assert f"{system.model.nq} numbers of configuration" in html


def test_every_column_of_a_card_that_has_numbers_has_a_head(pair):
    """A head stands on the side on which its numbers do."""
    cells = re.findall(r"<th([^>]*)>([^<]*)</th>", pair[1]._repr_html_())
    assert [text for look, text in cells if look and not text] == []
    assert ' class="n"' in {look for look, text in cells if text == "rate at the end"}


def test_numbers_of_a_card_are_the_results(pair):
    """Each digit: behind a number in a table stands the float itself."""
    run = pair[1]
    tree = _Tree()
    tree.feed(run._repr_html_())
    summary = run.summary()
    for group in ("motion", "contacts"):
        for entries in summary[group].values():
            wanted = ("angle", "rate", "peak_acceleration", "peak_force", "peak_depth", "dissipated")
            for entry in set(wanted) & set(entries):
                assert entries[entry] in tree.exact, (group, entry)


def test_dir_lists_what_is_public():
    assert dir(antenna_pin) == sorted(antenna_pin.__all__)
    for room in ("plot", "analysis", "contact", "elements", "laws", "events", "scenario", "linear"):
        package = getattr(antenna_pin, room)
        assert dir(package) == sorted(package.__all__), room
        for name in dir(package):
            one = getattr(package, name)
            if inspect.isclass(one) or inspect.isfunction(one):
                assert re.match(r"\S", inspect.getdoc(one) or ""), (room, name)


def test_every_law_is_found():
    for table in (laws.NORMAL_LAWS, laws.FRICTION_LAWS, laws.DISSIPATIONS):
        for law in table.values():
            assert getattr(laws, law.__name__) is law
