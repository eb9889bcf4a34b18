"""The page as a file: safe, self-contained, of a sensible size; in a browser, on a phone, on paper."""

import base64
import dataclasses
import re

import pytest

from antenna_pin.errors import OutputError
from antenna_pin.show.plot import allowed_figures
from antenna_pin.show.record import shared_head
from antenna_pin.show.report import figures, report
from antenna_pin.show.report._runs import ideal_of, reported

HOSTILE = "</title></script><script>window.bad = 1</script>\"'&"


@pytest.fixture
def saved(whole):
    return whole[1]


def test_text_of_others_is_escaped(ideal, play, shown):
    scenario = play.scenario.model_copy(update={"title": HOSTILE, "source": HOSTILE, "description": HOSTILE})
    data = play.data.assign_attrs(title=HOSTILE, case=HOSTILE)
    run = dataclasses.replace(play, data=data, scenario=scenario, message=HOSTILE)
    made = report([ideal, run], title=HOSTILE, figures=False)
    assert "<script>window.bad" not in made.html
    page = shown(made.html)
    assert page.text("//h1") == HOSTILE and page.text("//title") == HOSTILE
    assert HOSTILE in page.text("//section[@id='what-scenario']")


def test_nothing_is_loaded_from_elsewhere(saved):
    """Addresses that a page would load by itself; words in scripts and licences may name some."""
    html = saved.read_text(encoding="utf-8")
    loads = re.findall(
        r"<(?:link|img|script|iframe|source|video|audio)\b[^>]*?(?:src|href)=[\"']([^\"']*)", html
    )
    assert loads and all(address.startswith("data:") for address in loads)
    assert not re.search(r"@import|url\(\s*[\"']?(?!data:)\w+:", html[: html.index("</style>")])


def test_the_viewer_is_there_once_and_only_with_recordings(saved, ideal, play):
    html = saved.read_text(encoding="utf-8")
    assert html.count('class="ap-frame"') == 2  # the mechanism and the joint
    assert html.count(shared_head(packed=True).html.strip()) == 1
    plain = report([ideal, play], figures=False, recordings=False).html
    assert (
        "meshcat" not in plain and '<figure class="picture"' not in plain and 'class="ap-frame"' not in plain
    )
    assert len(html) < 4e6 and len(plain) < 2e5


def test_saving_where_it_cannot_be(ideal, tmp_path):
    made = report(ideal, figures=False, recordings=False)
    with pytest.raises(OutputError, match="folder"):
        made.save(tmp_path / "missing" / "report.html")
    assert made.save(tmp_path / "report.html").read_text(encoding="utf-8") == made.html
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_a_notebook_shows_it_in_a_frame(ideal):
    made = report(ideal, figures=False, recordings=False)
    assert made._repr_html_().startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')


@pytest.mark.parametrize(
    ("width", "height", "mobile"),
    [(380, 760, True), (1280, 900, False), pytest.param(1400, 900, False, marks=pytest.mark.slow)],
)
def test_no_page_is_wider_than_its_screen(check_width, saved, width, height, mobile):
    check_width(saved, width, height, mobile)


def test_figures_are_pictures_within_the_page(page, saved):
    page.open(saved, 1280, 900)
    sizes = page.run(
        "await report.ready;"
        "const all = [...document.querySelectorAll('.picture img')];"
        "for (const one of all) await one.decode();"
        "return all.map((one) => [one.naturalWidth, one.naturalHeight, one.alt]);"
    )
    assert len(sizes) >= 15
    for width, height, caption in sizes:
        assert width > 300 and height > 200 and caption


@pytest.mark.slow
def test_figures_are_large_on_a_screen_and_fill_a_phone(page, saved):
    """Up to 1.5 times as wide as they are drawn; on a phone each is moved within a box that fills it."""
    for screen, least, picture in ((1400, 1000, 1000), (1280, 900, 900), (800, 700, 700), (380, 340, 560)):
        page.open(saved, screen, 900)
        page.resize(screen, 900, screen < 500)
        boxes = page.run(
            "await report.ready;"
            "return [...document.querySelectorAll('.pictures .picture:not(.other)')].map((one) => {"
            "  const sheet = one.querySelector('.sheet').getBoundingClientRect();"
            "  return [sheet.left, sheet.right, one.querySelector('img').getBoundingClientRect().width];"
            "});"
        )
        assert len(boxes) >= 4
        for left, right, width in boxes:
            assert left >= 0.0 and right <= screen and right - left >= least and width >= picture, screen


def test_tall_figures_are_drawn_in_parts_that_fit_on_a_page(ideal, play):
    """Energy has three panels for each run: of seven runs it would be a third of a metre tall."""
    runs = reported([ideal, *((f"run {k}", play) for k in range(6))])
    given = [(run.label, run.run) for run in runs]
    (energy,) = allowed_figures(given, names=["energy"])
    parts = list(figures._parts(energy, runs, figures._short_names(runs), ideal_of(runs)))
    assert [name for _, names in parts for name in names] == ["case1", *(f"run {k}" for k in range(6))]
    assert len(parts) > 1
    assert all(25.4 * figure.get_figheight() <= figures.TALLEST for figure, _ in parts)
    assert 25.4 * energy.draw(given, width="page").get_figheight() > figures.TALLEST


def test_long_names_of_runs_are_cut_in_figures_and_stay_apart(play):
    runs = reported(
        [("the same long beginning of a name, one", play), ("the same long beginning of a name", play)]
    )
    names = figures._short_names(runs)
    assert len(set(names.values())) == 2 and max(map(len, names.values())) <= 20


def test_recordings_start_when_they_are_scrolled_to(page, saved):
    page.open(saved, 380, 500)
    assert page.run("await AntennaPin.ready; return AntennaPin.players.length;") == 0
    page.run(
        "for (const frame of document.querySelectorAll('.ap-frame')) {"
        "  frame.scrollIntoView();"
        "  const t = performance.now();"
        "  while (!frame.querySelector('canvas') && performance.now() - t < 20000)"
        "    await new Promise((done) => setTimeout(done, 20));"
        "}"
        "for (const player of AntennaPin.players) await player.ready;"
    )
    assert page.run("return AntennaPin.players.length;") == 2
    assert page.errors == [] and page.requests == []


def test_prints_on_a_few_pages(page, saved):
    """A4, no more pages than text and tables (ten), figures with captions (four) and stills (one) take."""
    page.open(saved, 1000, 800)
    printed = page.browser.command("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
    pdf = base64.b64decode(printed["data"])
    sizes = re.findall(rb"/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]", pdf)
    assert 5 <= len(sizes) <= 15
    # 210 x 297 mm in points of 1/72 inch, to a point.
    assert all((float(w), float(h)) == pytest.approx((595.3, 841.9), abs=1.5) for w, h in sizes)
    # On paper what moves stands still, after it has begun, and there is nothing that is not opened.
    page.run("window.dispatchEvent(new Event('beforeprint'));")
    page.browser.command("Emulation.setEmulatedMedia", media="print")
    try:
        left = page.run(
            "return [...document.querySelectorAll('nav, dialog, details:not(.paper)')].filter((e) => "
            "e.getBoundingClientRect().height > 0).length;"
        )
        stills = page.run(
            "return [...document.querySelectorAll('.recording')].map((e) => [e.querySelector('.ap-time'), "
            "e.querySelector('.ap-still')].map((part) => part && (part.textContent || "
            "part.getBoundingClientRect().width)));"
        )
    finally:
        page.browser.command("Emulation.setEmulatedMedia", media="")
        page.run("window.dispatchEvent(new Event('afterprint'));")
    assert left == 0
    assert len(stills) == 2
    assert all(width > 300.0 and float(time.split()[0]) > 0.0 for time, width in stills)
    assert page.errors == [] and page.requests == []
