"""From the text of a URDF to its elements: well-formed XML, and what other parsers of URDFs forgive.

Those are a default namespace, a prefix that nothing declares, two hyphens in a comment, what stands before
the XML declaration, and a version of XML that there is not (PyBullet's 0.0). Each is mended in the text, so
that what is written can be read by any parser. Lines keep their numbers.
"""

from __future__ import annotations

import re
from typing import Any

from lxml import etree

from antenna_pin.errors import MechanismError

__all__ = ["is_xacro", "name_of", "parsed", "root_of", "tag_of", "write"]

_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
# Nothing is tried twice (*+): a text with many comments would take for ever.
_BEFORE_DECLARATION = re.compile(r"\A((?:\s++|<!--(?:(?!-->).)*+-->)*+)<\?xml\s[^>]*\?>", re.DOTALL)
_VERSION = re.compile(r"""\A(\s*<\?xml\s+version\s*=\s*)(?:"[^"]*"|'[^']*')""")
_PREFIX = re.compile(r"Namespace prefix (\S+) (?:on|for) ")
_XACRO = "http://www.ros.org/wiki/xacro"

# Mends of one text, each of which another can come up behind.
_MENDS = 8


def root_of(text: str, where: str) -> Any:
    """Return the root element of a text, by names without the root's own namespace.

    Args:
        text: The XML.
        where: Name of the file, for messages.

    Raises:
        MechanismError: It is not well-formed XML.
    """
    text = text.removeprefix("\ufeff")
    early = _BEFORE_DECLARATION.match(text)
    if early and early[1]:
        text = early[1] + text[early.end() :]
    for _ in range(_MENDS):
        parser = _parser()
        try:
            return _without_namespace(_parsed(text, parser))
        except etree.XMLSyntaxError as error:
            mended = _mended(text, parser)
            if mended == text:
                what = re.sub(r",? *line \d+.*$", "", error.msg or "the document is empty").strip()
                raise MechanismError(
                    f"{where}, line {error.lineno or 1}: not well-formed XML: {what}"
                ) from None
            text = mended
    raise MechanismError(f"{where}, line 1: not well-formed XML: too many faults")


def parsed(text: str) -> Any:
    """Return the root element of a text that :func:`write` has made."""
    return _parsed(text, _parser())


def write(robot: Any) -> str:
    """Return the text of a URDF, comments included, one newline at its end."""
    tree = robot.getroottree()
    kinds = tree.docinfo.internalDTD
    if kinds is not None and not any(kinds.iterentities()):
        tree.docinfo.clear()  # a DOCTYPE that declares nothing
    text: str = etree.tostring(tree, encoding="unicode")
    return text.rstrip() + "\n"


def tag_of(element: Any) -> str:
    """Return the name of an element as it is written: with its prefix, if it has one."""
    name = etree.QName(element).localname
    return f"{element.prefix}:{name}" if element.prefix else str(name)


def name_of(element: Any, key: str) -> str:
    """Return the name of an attribute as it is written: with its prefix, if it has one."""
    name = etree.QName(key)
    prefix = next((one for one, space in element.nsmap.items() if space == name.namespace), None)
    return f"{prefix}:{name.localname}" if prefix else str(name.localname)


def is_xacro(element: Any) -> bool:
    """Whether an element is one of xacro's."""
    return "xacro" in (etree.QName(element).namespace or "")


def _parser() -> Any:
    return etree.XMLParser(encoding="utf-8", resolve_entities=False, no_network=True)


def _parsed(text: str, parser: Any) -> Any:
    # What no file can hold, half a letter, makes it XML that is not well-formed.
    return etree.fromstring(text.encode("utf-8", "surrogatepass"), parser)


def _mended(text: str, parser: Any) -> str:
    """Return a text in which what a parser stumbled over is mended, if it can be."""
    faults = {fault.type_name for fault in parser.error_log}
    if "ERR_UNKNOWN_VERSION" in faults:
        return _VERSION.sub(r'\1"1.0"', text)
    if "ERR_HYPHEN_IN_COMMENT" in faults:
        return _COMMENT.sub(lambda found: f"<!--{_without_hyphens(found[1])}-->", text)
    if faults == {"NS_ERR_UNDEFINED_NAMESPACE"}:
        prefixes = dict.fromkeys(
            found[1] for fault in parser.error_log if (found := _PREFIX.search(fault.message))
        )
        declared = "".join(
            f' xmlns:{prefix}="{_XACRO if prefix == "xacro" else f"undeclared:{prefix}"}"'
            for prefix in prefixes
        )
        bare = _COMMENT.sub(lambda found: " " * len(found[0]), text)  # a root in a comment is none
        start = re.search(r"<[A-Za-z_][^\s/>]*", bare)
        if declared and start:
            return text[: start.end()] + declared + text[start.end() :]
    return text


def _without_hyphens(comment: str) -> str:
    spaced = re.sub(r"-(?=-)", "- ", comment)
    return f"{spaced} " if spaced.endswith("-") else spaced


def _without_namespace(robot: Any) -> Any:
    """Take the namespace that the root itself is in off all names."""
    own = etree.QName(robot).namespace
    if own:
        for element in robot.iter(etree.Element):
            if etree.QName(element).namespace == own:
                element.tag = etree.QName(element).localname
        etree.cleanup_namespaces(robot, keep_ns_prefixes=[prefix for prefix in robot.nsmap if prefix])
    return robot
