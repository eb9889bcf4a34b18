"""Whole pages: what they may do in a browser, and how a notebook shows one."""

from __future__ import annotations

import base64
import hashlib
from html import escape

__all__ = ["in_frame", "policy", "script"]


def script(text: str) -> str:
    """Return a text as a script element can hold it; what would end that early is written in another way."""
    return "\n" + text.replace("</script", r"<\/script").replace("<!--", r"<\!--") + "\n"


def policy(*scripts: str) -> str:
    """Return the element of a page's head by which it reaches no network and runs no scripts but its own.

    Text that got into a page as markup, from a file of a stranger's, could run nothing and send nothing away.

    Args:
        *scripts: The contents of its script elements, to the letter (:func:`script`).
    """
    digests = (hashlib.sha256(text.encode()).digest() for text in scripts)
    own = " ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests) or "'none'"
    rules = (
        "default-src 'none'",
        f"script-src {own}",
        "style-src 'unsafe-inline'",  # colours and places of single elements
        "img-src data: blob:",
        "font-src data:",
        "connect-src data: blob:",  # textures of meshes, which stand in the page
        "base-uri 'none'",
        "form-action 'none'",
    )
    return f'<meta http-equiv="Content-Security-Policy" content="{"; ".join(rules)}">\n'


def in_frame(page: str, height: str) -> str:
    """Return a whole page as a part of a notebook, in a frame of its own that reaches nothing outside.

    Args:
        page: Its HTML.
        height: CSS height of the frame.
    """
    source = escape(page, quote=True)
    return (
        f'<iframe srcdoc="{source}" sandbox="allow-scripts" style="width:100%;height:{height};border:0" '
        "allowfullscreen></iframe>"
    )
