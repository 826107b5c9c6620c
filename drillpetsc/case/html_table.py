"""A table of texts as HTML."""

from __future__ import annotations

import html
from collections.abc import Iterable


def html_table(heads: Iterable[str], rows: Iterable[Iterable[str]], caption: str = "") -> str:
    """The table with its heads, and with a caption where there is one."""

    def row(kind: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{kind}>{html.escape(cell)}</{kind}>" for cell in cells) + "</tr>"

    title = f"<caption>{html.escape(caption)}</caption>" if caption else ""
    return f"<table>{title}{row('th', heads)}{''.join(row('td', cells) for cells in rows)}</table>"
