"""The page of every command and option, as ``--help`` has them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from typer.main import get_command

from antenna_pin.apps.cli import app


def commands(command: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield each command with its whole name, groups before what they hold."""
    yield name, command
    for part, each in getattr(command, "commands", {}).items():
        if not each.hidden:
            yield from commands(each, f"{name} {part}")


def cell(text: str | None) -> str:
    """Return text as the cell of a table."""
    return " ".join((text or "").split()).replace("|", "\\|").replace("<", "&lt;")


def rows(command: Any, context: Any) -> list[str]:
    """Return the arguments and options of a command as rows."""
    lines = []
    for one in command.params:
        if getattr(one, "hidden", False):
            continue
        if one.param_type_name == "argument":
            names, said = (one.name or "").upper(), getattr(one, "help", "")
        else:
            names, said = one.get_help_record(context) or (", ".join(one.opts), "")
        lines.append(f"| `{names.replace('|', '/')}` | {cell(said)} |")
    return lines


def commands_page() -> str:
    """Return the page, in Markdown."""
    parts = [
        "# Every command and option",
        "",
        "What `--help` says; [by task](../command-line.md) with their output.",
        "",
    ]
    for name, command in commands(get_command(app), "antenna-pin"):
        context = command.context_class(command, info_name=name)
        usage = " ".join([name, *command.collect_usage_pieces(context)])
        parts += [
            f"## {name}",
            "",
            cell((command.help or "").split("\f")[0]),
            "",
            f"```text\n{usage}\n```",
            "",
        ]
        if found := rows(command, context):
            parts += ["| argument or option | meaning |", "|---|---|", *found, ""]
    return "\n".join(parts)
