"""Changes of a file's bytes, whatever its format."""

from __future__ import annotations

from random import Random

from fuzzing.inputs import Change

__all__ = ["text_change"]


def _lines(content: bytes) -> list[bytes]:
    return content.split(b"\n")


def text_change(chance: Random) -> Change:
    """Return a change that takes a file's bytes and returns others."""
    at, other, letter = chance.random(), chance.random(), bytes([chance.randrange(256)])

    def place(content: bytes) -> int:
        return int(at * len(content))

    def cut(content: bytes) -> bytes:
        return content[: place(content)]

    def begun_late(content: bytes) -> bytes:
        return content[place(content) :]

    def flipped(content: bytes) -> bytes:
        k = place(content)
        return content[:k] + letter + content[k + 1 :]

    def inserted(content: bytes) -> bytes:
        k = place(content)
        return content[:k] + letter * chance_count + content[k:]

    def line_twice(content: bytes) -> bytes:
        lines = _lines(content)
        k = int(at * len(lines))
        return b"\n".join([*lines[:k], *lines[k : k + 1] * 2, *lines[k + 1 :]])

    def line_lost(content: bytes) -> bytes:
        lines = _lines(content)
        k = int(at * len(lines))
        return b"\n".join(lines[:k] + lines[k + 1 :])

    def lines_swapped(content: bytes) -> bytes:
        lines = _lines(content)
        k, n = int(at * len(lines)), int(other * len(lines))
        lines[k], lines[n] = lines[n], lines[k]
        return b"\n".join(lines)

    def line_ends(content: bytes) -> bytes:
        return content.replace(b"\n", b"\r\n" if at < 0.5 else b"\r")

    def marked(content: bytes) -> bytes:
        return b"\xef\xbb\xbf" + content

    def wide(content: bytes) -> bytes:
        return content.decode("utf-8", "replace").encode("utf-16" if at < 0.5 else "utf-16-le")

    def latin(content: bytes) -> bytes:
        return content + "# schön\n".encode("latin-1")

    def numbers_moved(content: bytes) -> bytes:
        return content.replace(b".", b",") if at < 0.5 else content.replace(b"e-", b"e+")

    def repeated(content: bytes) -> bytes:
        return content * 2

    def emptied(content: bytes) -> bytes:
        return b"" if at < 0.5 else bytes(100)

    chance_count = chance.choice((1, 1, 1, 10, 100_000))
    edits = (
        cut,
        begun_late,
        flipped,
        flipped,
        flipped,
        inserted,
        inserted,
        line_twice,
        line_lost,
        lines_swapped,
    )
    edits += (line_ends, marked, wide, latin, numbers_moved, repeated, emptied)
    edit = chance.choice(edits)
    name = edit.__name__.replace("_", " ")
    if edit in (flipped, inserted):
        name += f" {letter!r}" + (f" times {chance_count}" if edit is inserted else "")
    return Change(f"text {name} at {at:.3f}", edit)
