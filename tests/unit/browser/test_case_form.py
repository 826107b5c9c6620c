"""The form of a case: values are edited in the text, nothing else of it changes, and it is written on request only."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import pytest
import yaml

from drillpetsc.browser.case_form import CaseForm
from drillpetsc.browser.yaml_edit import with_value, without
from drillpetsc.errors import CaseError

ROOT = Path(__file__).parents[3]
TEXT = """# a comment
title: A case   # of a test
string:                 # from the top
  - {kind: pipe, od: 127 mm, id: 108 mm}   # drill pipe
  - kind: bit
    od: 8.5 in  # inches
well:
  survey:
    md: [0 m, 100 m]
  # before the sections
  sections:
    - {to: 100 m}

top: {}
"""


@pytest.mark.parametrize(
    ("at", "value", "old", "new"),
    [
        ("title", "Another", "title: A case   #", "title: Another   #"),
        ("string[0].od", "5 in", "od: 127 mm,", "od: 5 in,"),
        ("string[1].od", "215.9 mm", "od: 8.5 in  #", "od: 215.9 mm  #"),
        ("well.survey.md", "[0 m, 50 m]", "[0 m, 100 m]", "[0 m, 50 m]"),
        ("string[0].length", "9 m", "id: 108 mm}", "id: 108 mm, length: 9 m}"),
        ("string[1].mass", "50 kg", "od: 8.5 in  # inches\n", "od: 8.5 in  # inches\n    mass: 50 kg\n"),
        ("top.kind", "pinned", "top: {}", "top: {kind: pinned}"),
        ("string[1]", "{kind: bit}", "kind: bit\n    od: 8.5 in  # inches", "{kind: bit}  # inches"),
        ("time", "{end: 1 s}", "top: {}\n", "top: {}\ntime: {end: 1 s}\n"),
    ],
)
def test_a_value_is_set_and_the_rest_stays(at: str, value: str, old: str, new: str) -> None:
    assert TEXT.count(old) == 1
    assert with_value(TEXT, at, value) == TEXT.replace(old, new)


@pytest.mark.parametrize(
    ("at", "old", "new"),
    [
        ("title", "title: A case   # of a test\n", ""),
        ("string[0].kind", "kind: pipe, ", ""),
        ("string[0].id", ", id: 108 mm", ""),
        ("string[1].od", "    od: 8.5 in  # inches\n", ""),
        ("string[1].kind", "kind: bit\n    od", "od"),
        ("string[0]", "  - {kind: pipe, od: 127 mm, id: 108 mm}   # drill pipe\n", ""),
        ("well.survey", "  survey:\n    md: [0 m, 100 m]\n", ""),
    ],
)
def test_a_key_is_removed_and_the_rest_stays(at: str, old: str, new: str) -> None:
    assert TEXT.count(old) == 1
    assert without(TEXT, at) == TEXT.replace(old, new)


@pytest.mark.parametrize("at", ["string[2].od", "well.path.md", "title.of", "string.od", "string[0"])
def test_a_path_that_is_not_there_is_refused(at: str) -> None:
    with pytest.raises(CaseError):
        with_value(TEXT, at, "1")
    with pytest.raises(CaseError):
        without(TEXT, at)


@pytest.mark.parametrize("value", ["[1, 2", "{a: b", "x: y: z", "a\nb", " "])
def test_a_value_that_breaks_the_text_is_refused(value: str) -> None:
    with pytest.raises(CaseError) as error:
        with_value(TEXT, "string[0].od", value)
    assert error.value.at == "string[0].od"


def test_every_value_of_every_case_can_be_set_and_removed() -> None:
    """Data after the edit are those of the edited data, by another YAML reader; case files of the project."""

    def paths(data: Any, at: str) -> list[str]:
        if isinstance(data, dict):
            return [
                p
                for k, v in data.items()
                for p in [f"{at}.{k}" if at else k, *paths(v, f"{at}.{k}" if at else k)]
            ]
        if isinstance(data, list):
            return [p for i, v in enumerate(data) for p in [f"{at}[{i}]", *paths(v, f"{at}[{i}]")]]
        return []

    for name in ("directional", "field/metric"):
        text = (ROOT / "cases" / f"{name}.yaml").read_text()
        for at in paths(yaml.safe_load(text), "")[::8]:
            data = yaml.safe_load(text)
            assert set_in(data, at, "new") == yaml.safe_load(with_value(text, at, "new")), (name, at)
            left = remove_in(yaml.safe_load(text), at)
            assert left == yaml.safe_load(without(text, at)), (name, at)


def holder(data: Any, at: str) -> tuple[Any, Any]:
    steps = [
        int(s[1:]) if s.startswith("[") else s for s in at.replace("[", ".[").replace("]", "").split(".")
    ]
    for number, step in enumerate(steps):
        if isinstance(data, dict):  # a key may be a number, as of a viscometer
            step = next(key for key in data if str(key) == step)
        if number == len(steps) - 1:
            return data, step
        data = data[step]
    raise AssertionError(at)


def set_in(data: Any, at: str, value: str) -> Any:
    inside, last = holder(data, at)
    inside[last] = value
    return data


def remove_in(data: Any, at: str) -> Any:
    inside, last = holder(data, at)
    if len(inside) == 1 and inside is not data:
        return remove_in(data, at[: max(at.rfind("."), at.rfind("["))])
    del inside[last]
    return data


@pytest.fixture
def form(tmp_path: Path) -> CaseForm:
    file = tmp_path / "case.yaml"
    file.write_text((ROOT / "cases" / "lying-string.yaml").read_text())
    return CaseForm(file)


def part(parts: list[dict[str, Any]], at: str) -> dict[str, Any]:
    """The part of a form with this key path."""
    found = [
        each for each in parts if each["at"] == at or at.startswith((f"{each['at']}.", f"{each['at']}["))
    ]
    assert len(found) == 1, at
    return found[0] if found[0]["at"] == at else part(found[0]["parts"], at)


def test_the_form_has_values_choices_and_the_answer_of_check(form: CaseForm) -> None:
    answer = form.open()
    assert answer["errors"] == [] and "Lying string, rotating: valid" in answer["report"]
    kind = part(answer["form"], "string[0].kind")
    assert (
        kind["value"] == "pipe" and {"stabilizer", "bit", "jar"} <= set(kind["choices"]) and kind["required"]
    )
    od = part(answer["form"], "string[0].od")
    assert od["value"] == "127 mm" and od["choices"] == [] and od["about"] == "outer diameter [m]"
    mode = next(each for each in part(answer["form"], "time")["absent"] if each["key"] == "mode")
    assert mode["choices"] == ["dynamic", "quasi_static"] and mode["default"] == "dynamic"
    assert "fluid" in [each["key"] for each in answer["absent"]]


def test_errors_name_key_line_and_what_is_allowed(form: CaseForm) -> None:
    text = form.open()["text"]
    answer = form.edit({"text": text, "at": "string[0].od", "value": "-5 in"})
    (error,) = answer["errors"]
    assert error["at"] == "string[0].od" and "at most" in error["want"] and error["got"] == "-5 in"
    assert answer["text"].splitlines()[error["line"] - 1].count("-5 in") == 1
    assert part(answer["form"], "string[0].od")["value"] == "-5 in" and answer["report"] == ""
    broken = form.check({"text": "title: [a"})
    assert broken["form"] == [] and broken["errors"][0]["line"] == 1
    missing = form.check({"text": "title: a\n"})
    assert "string" in [each["at"] for each in missing["errors"]]


def test_a_switched_kind_offers_its_keys(form: CaseForm) -> None:
    answer = form.edit({"text": form.open()["text"], "at": "top.kind", "value": "pinned"})
    assert {"clamped", "pinned", "top_drive"} <= set(part(answer["form"], "top.kind")["choices"])
    assert "top.rotation" in [error["at"] for error in answer["errors"]]  # a pinned top does not turn


def test_nothing_is_written_but_by_save(form: CaseForm) -> None:
    opened = form.open()
    before = form.path.read_bytes()
    text = form.edit({"text": opened["text"], "at": "title", "value": "New"})["text"]
    assert form.path.read_bytes() == before
    form.path.chmod(0o640)
    digest = form.save({"text": text, "digest": opened["digest"]})["digest"]
    assert form.path.read_text() == text and stat.S_IMODE(form.path.stat().st_mode) == 0o640
    form.path.write_text("another: text\n")
    with pytest.raises(ValueError, match="another program"):
        form.save({"text": text, "digest": digest})
    assert form.path.read_text() == "another: text\n"
    assert os.listdir(form.path.parent) == ["case.yaml"]


def test_line_ends_and_links_stay(form: CaseForm, tmp_path: Path) -> None:
    form.path.write_bytes(b"\xef\xbb\xbf" + form.path.read_bytes().replace(b"\n", b"\r\n"))
    link = tmp_path / "link.yaml"
    link.symlink_to(form.path)
    linked = CaseForm(link)
    opened = linked.open()
    linked.save({"text": opened["text"].replace("Lying", "Another"), "digest": opened["digest"]})
    raw = form.path.read_bytes()
    assert link.is_symlink() and raw.startswith(b"\xef\xbb\xbf") and b"Another" in raw
    assert raw.count(b"\r\n") == raw.count(b"\n")
