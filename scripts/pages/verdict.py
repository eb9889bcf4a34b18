"""What is to be said against a site that was built: links to nowhere, what it would fetch, its sizes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: A page larger than this is not for reading [bytes].
LARGEST = 5_000_000
_HELD = {
    "a": "href",
    "img": "src",
    "script": "src",
    "link": "href",
    "iframe": "src",
    "source": "src",
    "video": "src",
}


class _Links(HTMLParser):
    """The links of a page, what it asks for by itself, and its anchors."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.anchors: set[str] = {"", "top"}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of one element."""
        given = dict(attrs)
        self.anchors.update(given[key] or "" for key in ("id", "name") if key in given)
        address = given.get(_HELD.get(tag, ""))
        if address:
            leads = tag == "a" or (
                tag == "link" and given.get("rel") in ("canonical", "next", "prev", "search", "index")
            )
            (self.links if leads else self.fetched).append(address)


def complaints(site: Path) -> list[str]:
    """Return a line for each thing that is wrong with a site."""
    site = site.resolve()

    @cache
    def read(page: Path) -> _Links:
        found = _Links()
        found.feed(page.read_text())
        return found

    pages = sorted(page for page in site.rglob("*.html") if "_static" not in page.parts)
    said = []
    for page in pages:
        place = page.relative_to(site)
        if page.stat().st_size > LARGEST:
            said.append(
                f"{place}: {page.stat().st_size / 1e6:.1f} MB; a page has at most {LARGEST / 1e6:g} MB"
            )
        found = read(page)
        said += [f"{place}: fetches {one} of the network" for one in found.fetched if urlsplit(one).netloc]
        said += [f"{place}: {word}" for word in _broken(page, found, site, read)]
    return said


def _broken(page: Path, found: _Links, site: Path, read: Callable[[Path], _Links]) -> Iterator[str]:
    """Yield what is wrong with the links of a page within the site."""
    for address in dict.fromkeys([*found.links, *found.fetched]):
        parts = urlsplit(address)
        if parts.scheme or parts.netloc:
            continue
        target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
        if target.is_dir():
            target /= "index.html"
        if not target.is_file() or not target.is_relative_to(site.resolve()):
            yield f"{address} leads to no file of the site"
        elif parts.fragment and target.suffix == ".html":
            if unquote(parts.fragment) not in read(target).anchors:
                yield f"{address} leads to no such anchor"
