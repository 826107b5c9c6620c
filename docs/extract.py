"""Commands and cases that the pages of the manual show, for the tests that run them.

A shell block is a fence ```console; its commands are the lines that begin with `$ `.
A complete case is a fence ```yaml whose first line is `# file: name.yaml` (a file beside it: ```python, `# file: name.py`), or a whole file shown by ```{literalinclude} that begins so.
The fences ```python of a page run one after the other in one namespace (`blocks(page, "python")`).
Other ```yaml fences are fragments: blocks that `with_fragment` lays over a small case to see whether they are valid.
Pages are read in the order of `pages()`; a command may use the cases of its own page and those in
`docs/tutorials/cases`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parent
FENCE = re.compile(
    r"^(?P<mark>`{3,})(?P<kind>[\w{}-]+)(?P<word>[^\n]*)\n(?P<text>.*?)^(?P=mark)\s*$",
    re.MULTILINE | re.DOTALL,
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


def shown(page: str | Path) -> list[tuple[str, list[str]]]:
    """Commands of a page in order, continuation lines joined, each with the lines of output that the page shows below it."""
    found: list[tuple[str, list[str]]] = []
    for block in blocks(page, "console"):
        for line in re.sub(r"\\\n\s*", " ", block).splitlines():
            if line.startswith("$ "):
                found.append((line[2:].strip(), []))
            elif line.strip() and found:
                found[-1][1].append(line)
    return found


def commands(page: str | Path) -> list[str]:
    """Commands of a page in order: `drillpetsc run case.yaml --out first`."""
    return [command for command, _ in shown(page)]


def cases(page: str | Path) -> dict[str, str]:
    """Complete cases of a page, and files of Python beside them: file name -> text."""
    found = {}
    for block in blocks(page, "yaml") + blocks(page, "python"):
        match = FILE.match(block)
        if match:
            found[match[1]] = block
    text = Path(page).read_text(encoding="utf-8")
    for fence in FENCE.finditer(text):
        if fence["kind"] == "{literalinclude}" and ":lines:" not in fence["text"]:
            block = (Path(page).parent / fence["word"].strip()).read_text(encoding="utf-8")
            match = FILE.match(block)
            if match:
                found[match[1]] = block
    return found


def fragments(page: str | Path) -> list[str]:
    """YAML fences of a page that are no complete cases."""
    return [block for block in blocks(page, "yaml") if not FILE.match(block)]


def with_fragment(fragment: dict[str, Any]) -> dict[str, Any]:
    """Keys of a small case with the blocks of a fragment in it; `Case(**with_fragment(...))` is to be valid."""
    well = {
        "survey": {"md": [0, 2100], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [{"to": "end", "kind": "open_hole", "diameter": "215.9 mm"}],
    }
    string = [
        {"kind": "pipe", "length": "1999.5 m", "od": "127 mm", "id": "108.6 mm"},
        {"kind": "bit", "length": "0.5 m", "od": "215.9 mm", "nozzle_area": "400 mm2"},
    ]
    return {"well": well, "string": string, "top": {"kind": "top_drive"}, "time": {"end": 1.0}, **fragment}


if __name__ == "__main__":
    for page in sys.argv[1:] or pages():
        print(f"{page}: {len(cases(page))} cases")
        for command in commands(page):
            print(f"    {command}")
