"""The site: every page has a place in it, links and anchors hold, and in a browser, offline, it can be read.

It is built by ``scripts/docs``. What needs a built site is slow, and builds it once.
"""

import importlib
import os
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
TREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)
#: Pages that are made while the site is built.
MADE = {
    "docs/reference/commands",
    "docs/reference/python/index",
    "docs/reference/models",
    "docs/gallery/index",
}


def site_module(monkeypatch, name):
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "pages"))
    return importlib.import_module(name)


def entries(page):
    """Return what a page's trees name, as paths from the root without ending."""
    found = []
    for body in TREE.findall(page.read_text()):
        for line in filter(None, body.splitlines()):
            if not line.startswith(":"):
                target = re.sub(r".*<(.*)>$", r"\1", line)
                path = os.path.normpath(page.parent / target)
                found.append(Path(path).relative_to(ROOT).as_posix())
    return found


# --- without a build ---


def test_every_page_has_one_place_in_the_trees():
    """A page in no tree is found by nobody; one in two has two places in the navigation."""
    named = [name for page in sorted(DOCS.rglob("*.md")) for name in entries(page)]
    assert len(named) == len(set(named))
    pages = {path.relative_to(ROOT).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    pages |= {"README", "CHANGELOG", "CONTRIBUTING"}
    assert set(named) == (pages | MADE) - {"docs/index"}


def test_every_theory_page_stands_in_its_table():
    index = (DOCS / "theory" / "index.md").read_text()
    for page in (DOCS / "theory").glob("*.md"):
        assert page.name == "index.md" or f"]({page.name})" in index


@pytest.mark.parametrize("page", sorted((DOCS / "theory").glob("*.md")), ids=lambda page: page.stem)
def test_formulas_are_closed(page):
    """A formula that is not closed would draw the rest of its page."""
    text = page.read_text()
    assert text.count("$$") % 2 == 0
    assert text.replace("$$", "").count("$") % 2 == 0
    assert text.count(r"\begin{") == text.count(r"\end{")
    for formula in re.findall(r"\$\$(.*?)\$\$", text, re.DOTALL):
        assert formula.count("{") == formula.count("}"), formula


def test_every_public_name_has_one_entry(monkeypatch):
    """On the page of the room that it is written in; other rooms that offer it lead there."""
    import antenna_pin

    pages = site_module(monkeypatch, "name_pages")
    made = pages.name_pages()
    entered = re.findall(
        r"^\.\. (?:autoclass|autofunction|py:data):: (\S+)$", "\n".join(made.values()), re.MULTILINE
    )
    assert len(entered) == len(set(entered))
    rooms = pages.public_rooms()
    for room, module in rooms.items():
        for name in module.__all__:
            home = pages.home_of(name, getattr(module, name), room, rooms)
            assert f"antenna_pin.{home}.{name}" in entered
    for name in antenna_pin.__all__:
        assert f"`antenna_pin.{name} <" in made["index"] or name in made
    # What a field is stands once, beside it or above it.
    fields = pages.fields_of(antenna_pin.analysis.Growth)
    assert fields["rate"] == "lambda of the exponential [1/s]" and len(fields) == 8
    assert "   - **rate**: lambda of the exponential [1/s]\n" in made["analysis"]
    above = pages.fields_of(antenna_pin.studies.linear.Linearisation)["rigid"]
    assert above.startswith("the six rigid-body directions") and above.endswith("if something holds it")


def test_every_command_has_a_heading(monkeypatch):
    from antenna_pin.apps.cli import _COMMANDS

    text = site_module(monkeypatch, "command_pages").commands_page()
    for name in _COMMANDS:
        assert f"\n## antenna-pin {name}\n" in text


@pytest.mark.parametrize("folder", ["gallery", "examples"])
def test_every_script_has_a_title_of_its_own(monkeypatch, folder):
    """It is what stands under its thumbnail, and in the navigation."""
    pages = site_module(monkeypatch, "example_pages")
    assert f"scripts/{folder}" in pages.GALLERIES
    titles = []
    for path in sorted((ROOT / "scripts" / folder).glob("*.py")):
        made = pages.as_page(path.read_text())
        first, line = made.splitlines()[:2]
        titles.append(first.removeprefix('"""'))
        assert line == "=" * len(titles[-1]) and 5 < len(titles[-1]) < 100
        compile(made, path.name, "exec")
        assert folder == "examples" or "\nfigure = " in made, "a picture is what the gallery is for"
    assert len(titles) == len(set(titles)) > 9


def test_what_the_gallery_made_of_a_script_goes_with_it(monkeypatch, tmp_path):
    """Else a build that goes on from an earlier one would have pages in no tree."""
    pages = site_module(monkeypatch, "example_pages")
    folder = tmp_path / "docs" / "gallery"
    folder.mkdir(parents=True)
    for name in ("gone.rst", "gone.py.md5", "backlash.rst", "index.rst"):
        (folder / name).touch()
    pages.forget_galleries(tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["backlash.rst", "index.rst"]


def test_what_is_wrong_with_a_site_is_told(monkeypatch, tmp_path):
    verdict = site_module(monkeypatch, "verdict")
    monkeypatch.setattr(verdict, "LARGEST", 200)
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="b.html#there">1</a><a href="c.html">2</a><a href="#here">3</a>'
        '<a href="https://example.org">4</a><script src="https://example.org/x.js"></script>'
    )
    (tmp_path / "b.html").write_text("<p>" + 200 * "long ")
    assert verdict.complaints(tmp_path) == [
        "a.html: fetches https://example.org/x.js of the network",
        "a.html: b.html#there leads to no such anchor",
        "a.html: c.html leads to no file of the site",
        "b.html: 0.0 MB; a page has at most 0.0002 MB",
    ]


def test_the_first_page_plays_a_recording(monkeypatch, tmp_path):
    """In the place of the picture of the player, which GitHub shows; it is small."""
    recording = site_module(monkeypatch, "first_recording")
    monkeypatch.setattr(recording, "_DURATION", 0.02)
    (tmp_path / "extra").mkdir()
    (tmp_path / "index.md").write_text((DOCS / "index.md").read_text())
    recording.add_recording(tmp_path)
    text = (tmp_path / "index.md").read_text()
    assert 'src="../recording.html"' in text and "recording_player.png" not in text
    assert (tmp_path / "extra" / "recording.html").stat().st_size < 2e6
    with pytest.raises(SystemExit, match="index.md must have the picture"):
        recording.add_recording(tmp_path)


# --- built, in a browser ---


@pytest.fixture(scope="module")
def site():
    sys.path.insert(0, str(ROOT / "scripts" / "pages"))
    try:
        return importlib.import_module("build_site").build()
    finally:
        sys.path.remove(str(ROOT / "scripts" / "pages"))


@pytest.mark.slow
def test_links_anchors_and_sizes_hold(site, monkeypatch):
    assert site_module(monkeypatch, "verdict").complaints(site) == []


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 400])
def test_a_formula_is_drawn_without_network(site, page, width):
    """MathJax has put its drawing where the formula was; the page is no wider than its view."""
    page.open(site / "docs" / "theory" / "impacts.html", width=width, height=900)
    drawn = page.run(
        "await MathJax.startup.promise; return [...document.querySelectorAll('div.math svg')]"
        ".map((one) => one.getBoundingClientRect().width);"
    )
    assert len(drawn) > 5 and min(drawn) > 10
    assert page.run("return document.documentElement.scrollWidth;") <= width
    assert not page.run("return document.body.innerText;").count("$$")
    assert [url for url in page.requests if not url.startswith("file:")] == []


@pytest.mark.slow
def test_search_finds_restitution(site, page):
    """What it finds comes in one by one; the pages that explain the word are among it."""
    page.open(f"{(site / 'search.html').resolve().as_uri()}?q=restitution", width=1400, height=900)
    for wanted in ("theory/laws.html", "theory/impacts.html"):
        assert page.run(
            "for (let k = 0; k < 200 && !document.querySelector(a[0]); k++)"
            " await new Promise((done) => setTimeout(done, 100));"
            " return document.querySelector(a[0]) !== null;",
            f"#search-results li a[href*='{wanted}']",
        )


@pytest.mark.slow
def test_it_is_dark_where_that_is_preferred(site, page):
    """Dark letters stand on light ground, or light ones on dark."""
    page.open(site / "docs" / "index.html", width=1400, height=900)
    code = "return getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3).map(Number);"
    light = page.run(code)
    page.prefer("dark")
    page.browser.open((site / "docs" / "index.html").resolve().as_uri())
    assert sum(light) > 600 > 200 > sum(page.run(code))
