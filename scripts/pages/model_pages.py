"""The page of the shipped mechanisms, which leads to what stands beside each."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]


def models_page() -> str:
    """Return the page, in Markdown: title and first sentence of each model's own."""
    lines = []
    for path in sorted((ROOT / "models").glob("*/README.md")):
        title = path.read_text().splitlines()[0].lstrip("# ")
        lines.append((path.parent.name, title))
    table = [f"| [`{name}`](../../models/{name}/README.md) | {title} |" for name, title in lines]
    tree = [f"{title} <../../models/{name}/README>" for name, title in lines]
    return "\n".join(
        [
            "# The models",
            "",
            "| name | what it is |",
            "|---|---|",
            *table,
            "",
            "```{toctree}",
            ":hidden:",
            "",
            *tree,
            "```",
            "",
        ]
    )
