"""Commands and cases that the pages of the manual show, for the tests that run them.

A shell block is a fence ```console; its commands are the lines that begin with `$ `.
A complete case is a fence ```yaml whose first line is `# file: name.yaml`.
Pages are read in the order of `pages()`; a command may use the cases of its own page and those in
`docs/tutorials/cases`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
FENCE = re.compile(
    r"^(?P<mark>`{3,})(?P<kind>[\w-]+)[^\n]*\n(?P<text>.*?)^(?P=mark)\s*$", re.MULTILINE | re.DOTALL
)
FILE = re.compile(r"#\s*file:\s*(\S+)")


def pages() -> list[Path]:
    """All pages that may show commands: guide, tutorials, index; in alphabetical order."""
    return [
        DOCS / "index.md",
        *sorted((DOCS / "guide").glob("*.md")),
        *sorted((DOCS / "tutorials").glob("*.md")),
    ]


def blocks(page: str | Path, kind: str) -> list[str]:
    """Texts of all fences of one kind (`console`, `yaml`, `python`) in a page."""
    text = Path(page).read_text(encoding="utf-8")
    return [match["text"] for match in FENCE.finditer(text) if match["kind"] == kind]


def commands(page: str | Path) -> list[str]:
    """Commands of a page in order, continuation lines joined: `drillpetsc run case.yaml --out first`."""
    found = []
    for block in blocks(page, "console"):
        lines = re.sub(r"\\\n\s*", " ", block).splitlines()
        found += [line[2:].strip() for line in lines if line.startswith("$ ")]
    return found


def cases(page: str | Path) -> dict[str, str]:
    """Complete cases of a page: file name -> text."""
    found = {}
    for block in blocks(page, "yaml"):
        match = FILE.match(block)
        if match:
            found[match[1]] = block
    return found


if __name__ == "__main__":
    for page in sys.argv[1:] or pages():
        print(f"{page}: {len(cases(page))} cases")
        for command in commands(page):
            print(f"    {command}")
