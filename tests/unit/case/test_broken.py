"""Every file in cases/broken is refused with the message that its first lines announce."""

from pathlib import Path

import pytest

from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

BROKEN = sorted((Path(__file__).parents[3] / "cases" / "broken").glob("*.yaml"))


def expected(path: Path) -> list[str]:
    mark = "# expect: "
    return [line[len(mark) :].strip() for line in path.read_text().splitlines() if line.startswith(mark)]


def test_there_are_enough_of_them() -> None:
    assert len(BROKEN) >= 20


@each_row("path", BROKEN, ids=lambda path: path.stem)
def test_message(path: Path) -> None:
    fragments = expected(path)
    assert fragments, f"{path.name} does not say what to expect"
    with pytest.raises(CaseError) as caught:
        load_case(path)
    message = str(caught.value)
    assert [fragment for fragment in fragments if fragment not in message] == [], message
    assert "allowed: " in message
    assert str(path.parent) in message
    assert caught.value.line is not None
    assert caught.value.exit_status == 2


def test_a_missing_file_is_named() -> None:
    with pytest.raises(CaseError) as caught:
        load_case(BROKEN[0].parent / "thick-bores.yaml")
    assert "thick-bores.yaml" in str(caught.value)
    assert "did you mean" in caught.value.hint and "thick-bore.yaml" in caught.value.hint


@each_row(
    ("content", "fragment"),
    [
        (b"\xff\xfe\x00string", "UTF-8"),
        (b"title: \x07", "YAML 1.2"),
        (b"a: &x\n  b: *x\n", "line 2: a.b"),
        (b"self: 1", "one of these keys"),
        (b"1: 2", "a word as key"),
        (b"title: 2001-01-01", "a number, text, list or mapping"),
        (b"title: !!python/object:os.system x", "allowed"),
        (b"? [a]\n: b", "a word as key"),
        (b"#only a comment\n", "an empty file"),
        (b"just words", "a mapping of keys"),
        (b"string: *nowhere", "YAML 1.2"),
    ],
)
def test_files_that_are_no_case(tmp_path: Path, content: bytes, fragment: str) -> None:
    path = tmp_path / "case.yaml"
    path.write_bytes(content)
    with pytest.raises(CaseError) as caught:
        load_case(path)
    assert fragment in str(caught.value)
    assert "case.yaml" in str(caught.value)


def test_a_folder_is_no_case(tmp_path: Path) -> None:
    with pytest.raises(CaseError):
        load_case(tmp_path)
