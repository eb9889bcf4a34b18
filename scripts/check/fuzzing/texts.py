"""Changes of a file's bytes, whatever its format."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from robust.inputs import Change


def text_change(chance: Random) -> Change:
    """Return a change that takes a file's bytes and returns others."""
    at, other, letter = chance.random(), chance.random(), bytes([chance.randrange(256)])
    times = chance.choice((1, 1, 1, 10, 100_000))

    def at_byte(edit: Callable[[bytes, int], bytes]) -> Callable[[bytes], bytes]:
        return lambda content: edit(content, int(at * len(content)))

    def of_lines(edit: Callable[[list[bytes], int], list[bytes]]) -> Callable[[bytes], bytes]:
        def edited(content: bytes) -> bytes:
            lines = content.split(b"\n")
            return b"\n".join(edit(lines, int(at * len(lines))))

        return edited

    def swapped(lines: list[bytes], k: int) -> list[bytes]:
        n = int(other * len(lines))
        lines[k], lines[n] = lines[n], lines[k]
        return lines

    first = at < 0.5
    edits: dict[str, Callable[[bytes], bytes]] = {
        "cut": at_byte(lambda content, k: content[:k]),
        "begun late": at_byte(lambda content, k: content[k:]),
        f"flipped {letter!r}": at_byte(lambda content, k: content[:k] + letter + content[k + 1 :]),
        f"inserted {letter!r} times {times}": at_byte(
            lambda content, k: content[:k] + letter * times + content[k:]
        ),
        "line twice": of_lines(lambda lines, k: lines[: k + 1] + lines[k:]),
        "line lost": of_lines(lambda lines, k: lines[:k] + lines[k + 1 :]),
        "lines swapped": of_lines(swapped),
        "line ends": lambda content: content.replace(b"\n", b"\r\n" if first else b"\r"),
        "marked": lambda content: b"\xef\xbb\xbf" + content,
        "wide": lambda content: content.decode("utf-8", "replace").encode("utf-16" if first else "utf-16-le"),
        "latin": lambda content: content + "# schön\n".encode("latin-1"),
        "numbers moved": lambda content: (
            content.replace(b".", b",") if first else content.replace(b"e-", b"e+")
        ),
        "repeated": lambda content: content * 2,
        "emptied": lambda content: b"" if first else bytes(100),
    }
    cut, late, flipped, inserted, *rest = edits
    name = chance.choice((cut, late, flipped, flipped, flipped, inserted, inserted, *rest))
    return Change(f"text {name} at {at:.3f}", edits[name])
