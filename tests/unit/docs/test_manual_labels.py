"""Citations between code and manual: labels that the code cites as "(manual: LABEL, LABEL)" exist in docs/, and
tests that the manual cites as `tests/file.py::function` exist.

DRILLPETSC_DOCS names another folder of the manual.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
DOCS = Path(os.environ.get("DRILLPETSC_DOCS", ROOT / "docs"))
FOLDERS = ("drillpetsc", "tests", "scripts", "cases")
SUFFIXES = (".py", ".hpp", ".cpp", ".yaml", ".md", "")
#: one or more labels after "manual:", separated by commas; comment signs may stand at the line breaks
CITATION = re.compile(
    r"(?<![Tt]he )\bmanual:\s+(?P<labels>[a-z0-9][\w-]*(?:,[\s#/*]+(?:eq|sec|verif)-[\w-]+)*)"
)
DEFINITION = re.compile(r"^\((?P<target>[\w-]+)\)=\s*$|:label:\s*(?P<equation>[\w-]+)", re.MULTILINE)


def labels_defined(docs: Path) -> set[str]:
    """Labels of sections, `(LABEL)=`, and of equations, `:label: LABEL`, in all pages below ``docs``."""
    found = set()
    for page in docs.rglob("*.md"):
        for match in DEFINITION.finditer(page.read_text(encoding="utf-8")):
            found.add(match["target"] or match["equation"])
    return found


def labels_cited(text: str) -> list[str]:
    """Labels cited in a text."""
    return [
        label.strip("-")
        for match in CITATION.finditer(text)
        for label in re.split(r",[\s#/*]+", match["labels"])
    ]


def wrong_citations(folder: Path, defined: set[str]) -> list[str]:
    """Citations of undefined labels below ``folder``, as `file: label`."""
    wrong = []
    for file in sorted(folder.rglob("*")):
        if (
            file.is_file()
            and file.suffix in SUFFIXES
            and "__pycache__" not in file.parts
            and file != Path(__file__)
        ):
            text = file.read_text(encoding="utf-8", errors="replace")
            wrong += [f"{file}: {label}" for label in labels_cited(text) if label not in defined]
    return wrong


@pytest.mark.parametrize("folder", FOLDERS)
def test_cited_labels_exist(folder: str) -> None:
    assert wrong_citations(ROOT / folder, labels_defined(DOCS)) == []


def test_the_tests_cite_the_manual() -> None:
    """The search finds citations; otherwise the tests above would pass for any label."""
    text = "".join(
        file.read_text(encoding="utf-8") for file in (ROOT / "tests" / "verification").glob("*.py")
    )
    assert len(set(labels_cited(text))) > 50


def test_a_wrong_label_is_found(tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("(verif-right)=\n# Title\n\n:label: eq-right\n")
    defined = labels_defined(tmp_path)
    assert defined == {"verif-right", "eq-right"}
    source = tmp_path / "source"
    source.mkdir()
    (source / "a.py").write_text('"""Good (manual: verif-right,\n# eq-right)."""\n')
    assert wrong_citations(source, defined) == []
    (source / "b.py").write_text('"""Bad (manual: verif-right, eq-wrong; and manual:\n    verif-wrong)."""\n')
    assert [each.split(": ")[1] for each in wrong_citations(source, defined)] == ["eq-wrong", "verif-wrong"]


def test_tests_cited_by_the_manual_exist() -> None:
    wrong = []
    for page in DOCS.rglob("*.md"):
        for match in re.finditer(r"\b(tests/[\w/]+\.py)(?:::(\w+))?", page.read_text(encoding="utf-8")):
            file = ROOT / match[1]
            found = file.is_file() and (
                not match[2] or f"def {match[2]}(" in file.read_text(encoding="utf-8")
            )
            wrong += [] if found else [f"{page}: {match[0]}"]
    assert wrong == []
