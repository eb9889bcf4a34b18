"""A report as people use it: dark or light, by its contents, figures enlarged and saved, on paper."""

import base64
import csv
import io
import re

import numpy as np
import pytest

from antenna_pin.show.report import report


@pytest.fixture
def made(whole):
    return whole[0]


@pytest.fixture
def saved(whole):
    return whole[1]


@pytest.fixture
def opened(page, saved):
    page.open(saved, 1400, 900)
    page.run("localStorage.clear(); await report.ready;")
    return page


# Where the page's paper is, away from all else.
_CORNER = (slice(700, 760), slice(60, 100))


def test_the_answer_is_on_the_first_screen(opened):
    """The sentence, the key numbers, a picture and a recording, all above the lower edge of 1400 x 900."""
    bottoms = opened.run(
        "return ['.status', '#table-key-results', '#figure-glance img', '#results .ap-frame'].map("
        "(one) => [...document.querySelectorAll(one)].pop().getBoundingClientRect().bottom);"
    )
    assert all(0 < bottom <= 900 for bottom in bottoms)
    text = opened.run("return [...document.querySelectorAll('.status')].pop().textContent;")
    assert re.search(r"Elevation: \d+ blows, at most [\d.]+\sN", text)


def test_dark_as_the_system_says_or_as_the_reader_chooses(opened):
    """Paper is dark, ink light; figures, drawn on white, are turned over, and recordings follow."""

    def lightness():
        picture = opened.screenshot()
        box = opened.run(
            "const box = document.querySelector('#figure-glance img').getBoundingClientRect();"
            "return [box.left, box.top, box.right, box.bottom].map(Math.round);"
        )
        figure = picture[box[1] : box[3], box[0] : box[2]]
        return picture[_CORNER].mean(), np.median(figure), figure.min(), figure.max()

    paper, sheet, ink, _ = lightness()
    assert paper > 240 and sheet > 240 and ink < 60
    opened.prefer("dark")
    paper, sheet, _, ink = lightness()
    assert paper < 50 and sheet < 50 and ink > 200
    choose = (
        "const one = document.querySelector('.theme select'); one.value = a[0];"
        "one.dispatchEvent(new Event('change')); await AntennaPin.ready;"
        "await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));"
        "return AntennaPin.players[0].root.classList.contains('ap-dark');"
    )
    opened.run("await AntennaPin.ready; document.querySelector('.ap-frame').scrollIntoView();")
    assert not opened.run(choose, "light")
    opened.run("scrollTo(0, 0);")
    paper, sheet, ink, _ = lightness()
    assert paper > 240 and sheet > 240 and ink < 60
    opened.prefer("light")
    assert opened.run(choose, "dark")
    assert lightness()[0] < 50
    assert opened.errors == [] and opened.requests == []


def test_contents_stay_in_view_and_mark_where_one_is(opened):
    for key in ("joint-elevation", "pointing", "results"):
        here, top, bottom = opened.run(
            "document.getElementById(a[0]).scrollIntoView();"
            "await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));"
            "const marked = [...document.querySelectorAll('nav a[aria-current]')];"
            "const box = marked[0].getBoundingClientRect();"
            "return [marked.map((one) => one.hash), box.top, box.bottom];",
            key,
        )
        assert here == [f"#{key}"] and top >= 0 and bottom <= 900
    # What is folded opens where the contents lead to it.
    assert opened.run(
        "document.querySelector('nav a[href=\"#what\"]').click();"
        "return document.querySelector('#what details').open;"
    )


def test_contents_of_a_phone_fold_into_a_line(page, saved):
    page.open(saved, 400, 800)
    page.resize(400, 800, True)
    seen = "return getComputedStyle(document.querySelector('nav ul')).display !== 'none';"
    assert not page.run(seen)
    page.run("document.querySelector('.unfold').click(); document.querySelector('nav a').focus();")
    assert page.run(seen)
    page.press("Escape")
    assert not page.run(seen)
    page.run("document.getElementById('base').scrollIntoView();")
    where = (
        "const nav = document.querySelector('nav');"
        "return [nav.querySelector('.unfold').textContent, nav.getBoundingClientRect().top];"
    )
    assert page.settles(["Base", 0], where) == ["Base", 0]


def test_one_figure_of_a_section_is_seen_at_a_time_by_keys_too(opened):
    seen = (
        "return [...document.querySelectorAll('#joint-elevation .pictures .picture')].filter("
        "(one) => one.getBoundingClientRect().height > 0).map((one) => one.id);"
    )
    assert opened.run(seen) == ["figure-angle-of-elevation"]
    opened.run("document.querySelector('#joint-elevation [role=tab][aria-selected=true]').focus();")
    opened.press("ArrowRight")
    assert opened.run(seen) == ["figure-rate-of-elevation"]
    opened.press("End")
    opened.press("ArrowRight")
    assert opened.run(seen) == ["figure-angle-of-elevation"]


def test_a_figure_is_enlarged_moved_and_closed(opened):
    place = (
        "const box = document.querySelector('.zoom img').getBoundingClientRect();"
        "return [box.left, box.top, box.width, box.height];"
    )
    opened.run(
        "const one = document.querySelector('#figure-angle-of-elevation .enlarge');"
        "one.scrollIntoView(); one.focus(); one.click();"
    )
    left, top, width, height = opened.run(place)
    assert 0 <= left and left + width <= 1400 and top + height <= 901
    # The wheel enlarges about the pointer: what is under it stays.
    x, y = 500.0, 400.0
    opened.browser.command("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-400)
    assert opened.settles(True, f"const box = (() => {{ {place} }})(); return box[2] > a[0];", 1.5 * width)
    nearer = opened.run(place)
    for before, after, size, larger, at in (
        (left, nearer[0], width, nearer[2], x),
        (top, nearer[1], height, nearer[3], y),
    ):
        # Places of a page are rounded to 1/64 px.
        assert (at - after) / larger == pytest.approx((at - before) / size, abs=1e-3)
    opened.point(x, y, "mousePressed")
    opened.browser.command(
        "Input.dispatchMouseEvent", type="mouseMoved", x=x - 40, y=y + 30, button="left", buttons=1
    )
    opened.point(x - 40, y + 30, "mouseReleased")
    moved = opened.run(place)
    assert moved[0] - nearer[0] == pytest.approx(-40, abs=0.1) and moved[1] - nearer[1] == pytest.approx(
        30, abs=0.1
    )
    opened.press("0")
    assert opened.run(place) == [left, top, width, height]
    opened.press("+")
    assert opened.run(place)[2] == pytest.approx(1.5 * width, abs=0.1)
    opened.press("Escape")
    assert opened.run("return [document.querySelector('.zoom').open, document.activeElement.className];") == [
        False,
        "enlarge",
    ]
    assert opened.errors == []


def test_numbers_of_a_figure_are_those_of_the_result(opened, ideal, play):
    text = opened.run("return await report.csv('angle-of-elevation');")
    head, *rows = csv.reader(io.StringIO(text))
    for run, label in ((play, "case3"), (ideal, "case1 (ideal)")):
        k = head.index(f"(a) whole span, {label}: time [s]")
        assert head[k + 1] == f"(a) whole span, {label}: elevation angle [mrad]"
        time, angle = (np.array([float(row[i]) for row in rows if row[i]]) for i in (k, k + 1))
        assert np.array_equal(time, run.data["time"].values)
        # Values have single precision, 2^-24, printed with nine digits.
        wanted = 1e3 * run.data["motion_angle"].sel(joint="elevation").values
        np.testing.assert_allclose(angle, wanted, rtol=2.0**-24 + 5e-9, atol=1e-45)


@pytest.mark.slow
def test_figures_and_their_numbers_are_saved_as_files(opened):
    opened.run(
        "const names = window.saved = [], blobs = window.blobs = [];"
        "HTMLAnchorElement.prototype.click = function () { names.push(this.download); };"
        "const make = URL.createObjectURL;"
        "URL.createObjectURL = (blob) => { blobs.push(blob); return make(blob); };"
        "for (const one of document.querySelectorAll('#figure-rate-of-elevation .save')) one.click();"
    )
    names = ["rate-of-elevation.svg", "rate-of-elevation.csv"]
    assert opened.settles(names, "return window.saved;") == names
    texts = opened.run("return Promise.all(window.blobs.map((one) => one.text()));")
    assert "<svg" in texts[0][:600] and texts[1].startswith('"(a) whole span, case3: time [s]"')
    # Every figure can be saved, and shows something that can be.
    figures, savers = opened.run(
        "return ['figure.picture', 'figure.picture .save'].map("
        "(one) => document.querySelectorAll(one).length);"
    )
    assert savers == 2 * figures > 20


@pytest.mark.slow
def test_paper_has_all_figures_with_their_captions_and_what_is_folded_for_room(opened):
    opened.run("await AntennaPin.ready;")
    printed = opened.browser.command("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
    assert base64.b64decode(printed["data"]).startswith(b"%PDF")
    opened.run("dispatchEvent(new Event('beforeprint'));")
    opened.browser.command("Emulation.setEmulatedMedia", media="print")
    try:
        figures, what = opened.run(
            "return [[...document.querySelectorAll('figure.picture')].map((one) => {"
            "  const [image, said] = ['img', 'figcaption'].map("
            "    (part) => one.querySelector(part).getBoundingClientRect());"
            "  return [image.height, said.height, said.top - image.bottom];"
            "}), document.querySelector('#what dl').getBoundingClientRect().height];"
        )
    finally:
        opened.browser.command("Emulation.setEmulatedMedia", media="")
        opened.run("dispatchEvent(new Event('afterprint'));")
    assert what > 10
    assert all(image > 100 and said > 5 and abs(apart) < 20 for image, said, apart in figures)
    assert not opened.run("return document.querySelector('#what details').open;")


def test_the_page_is_well_formed_and_of_five_megabytes_at_most(made, shown):
    page = shown(made.html)
    keys = page.tree.xpath("//@id")
    assert len(keys) == len(set(keys))
    assert all(image.get("alt") for image in page.tree.xpath("//img"))
    assert all(page.tree.xpath(f"//*[@id='{link.get('href')[1:]}']") for link in page.tree.xpath("//nav//a"))
    assert len(made.html) < 5e6


@pytest.fixture(scope="module")
def many(play):
    """Runs that would take thrice the room."""
    return report([("one", play), ("two", play), ("three", play), ("four", play)])


@pytest.mark.slow
def test_a_page_of_many_runs_is_no_larger(many):
    assert len(many.html.encode()) < 5e6
