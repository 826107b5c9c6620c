"""The quick reader of case files against ruamel: what it reads, ruamel reads as well, with the same values and lines."""

import random
from pathlib import Path

import pytest

from drillpetsc.case import load_case
from drillpetsc.case.files import plain_yaml
from drillpetsc.case.files.yaml_text import parse, plain, read_mapping, read_value
from drillpetsc.case.writer import _by_ruamel, case_data, case_yaml
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

CASES = Path(__file__).parents[3] / "cases"
PARTS = (
    [": ", ":", "#", " #", "- ", "-", " ", "\n", "\n  ", "\n- ", "[", "]", "{", "}", ",", "'", '"', "''", "&a ", "*a", "!t ", "|", ">"]
    + ["%", "@", "? ", "<<: ", "=", "~", "null", "true", "yes", "0x1F", "0o17", "010", "1_000", "1e5", ".5", "1.", "-.inf", ".nan", "+5"]
    + ["2001-01-01", "12:30", "-0.0", "---", "...", "\t", "\r\n", "\\", "é", "²", "\xa0", "\x85", "\u2028", "5 mm", "e", "x", "_", "0"]
    + ["dial: {600: 5, 300: 2}", "600: 3", "[1, 2,\n 3]", "{a: 1,\n b: 2}", "[]", "{a: [1 m], b: {c: 2}}", "# c\n", "k: v\n", "%YAML 1.1\n"]
)  # fmt: skip


def by_ruamel(text):
    lines = {}
    return plain(parse(text, None), (), lines, None), lines


def same(a, b):
    """Equal, and of the same types and order, down to the sign of a zero."""
    return repr(a) == repr(b)


def agrees(text):
    """Whether the quick reader takes the text; it must then have what ruamel has."""
    try:
        data, lines = plain_yaml.read(text)
    except plain_yaml.OtherYaml:
        return False
    expected, expected_lines = by_ruamel(text)
    assert same(data, expected), f"{text!r}: {data}, ruamel: {expected}"
    assert lines == expected_lines, f"{text!r}: {lines}, ruamel: {expected_lines}"
    return True


def test_cases():
    files = [file for file in sorted(CASES.rglob("*.yaml")) if file.parent.name != "broken"]
    assert sum(agrees(file.read_text(encoding="utf-8")) for file in files) > 0.95 * len(files)


def mutated(text, choose):
    for _ in range(choose.choice((1, 1, 2, 4))):
        at, rows = choose.randrange(len(text) + 1), text.split("\n")
        kind, row = choose.randrange(5), choose.randrange(len(rows))
        if kind < 2:
            text = text[:at] + choose.choice(PARTS) + text[at:]
        elif kind == 2:
            text = text[:at] + text[at + choose.randrange(1, 4) :]
        else:
            moved = " " * choose.randrange(6) + rows[row].lstrip() if kind == 3 else rows.pop(row)
            rows.insert(choose.randrange(len(rows) + 1), moved)
            text = "\n".join(rows)
    return text


def test_mutated_texts():
    """Texts of a few lines: a mistake is either left to ruamel, or none of ruamel's."""
    choose = random.Random(34)
    rows = [r for file in sorted(CASES.glob("*.yaml")) for r in file.read_text(encoding="utf-8").split("\n")]
    taken = 0
    for _ in range(2500):
        at = choose.randrange(len(rows))
        taken += agrees(mutated("\n".join(rows[at : at + choose.randrange(1, 8)]), choose))
    assert taken > 250


@each_row(
    "text",
    [
        "a: 1\na: 2", "a:\n", "a: null", "true: 1", "1: 2", "a: &x 1\nb: *x", "a: !t 1", "a: |\n  b", "a: b\n  c", "a: b: c", "a:\tb",
        "a: [1, 2", "a: [1 2]]", "a: {b}", "a: [b: 1]", "a: 1\n  b: 2", "a:\n    b: 1\n  c: 2", "- 1", "[1]", "a", "", "# c", "a: 1\n---\nb: 2",
        "a: 0x1F", "a: 1_000", "a: 2001-01-01", "a: .inf", "a: 'it''s'", 'a: "\\n"', "? a", "a: - b", "a: [1,\n---\n]", "a: [b\n c]",
        "a: '" + "x\n y'", "a: " + "[" * 60 + "]" * 60,
    ],
)  # fmt: skip
def test_left_to_ruamel(text):
    with pytest.raises(plain_yaml.OtherYaml):
        plain_yaml.read(text)


def test_line_of_a_mistake_is_of_ruamel(tmp_path):
    with pytest.raises(CaseError, match="a key given twice") as error:
        read_mapping("top: clamped\nbottom: free\ntop: free\n", tmp_path / "case.yaml")
    assert error.value.line == 3


@each_row(
    "text",
    ["90 rpm", "-3", "1.5e3", "true", "off", " x ", "5 1/2 in", "'a, b'", '"c"', "[1 m, 2 m]", "{kind: free}", "-0.0", "1e5", "12:30", "007"],
)  # fmt: skip
def test_one_value(text):
    assert same(read_value(text), plain(parse(text, None), (), {}, None))


def written(key, value):
    """Lines of the quick writer, which must be ruamel's; None if it leaves them to ruamel."""
    try:
        lines = plain_yaml.entry(key, value)
    except plain_yaml.OtherYaml:
        return None
    assert lines == _by_ruamel(key, value), f"{key}: {value!r}"
    return lines


def test_written_cases():
    for file in sorted(CASES.glob("*.yaml")):
        case = load_case(file)
        lines = [written(key, value) for key, value in case_data(case).items()]
        assert case_yaml(case).endswith("".join(filter(None, lines)))
        assert None not in lines


def test_written_values():
    """Values of any shape, whose texts are the same parts that break readers."""
    choose = random.Random(12)
    atoms = [
        *PARTS,
        "a b",
        "5 mm",
        "x?",
        "1e-5 s",
        "a, b",
        1,
        -2,
        0.0,
        -0.0,
        1e16,
        5e-324,
        float("inf"),
        True,
        None,
    ]

    def value(level):
        kind = choose.random()
        if level > 4 or kind < 0.5:
            return choose.choice(atoms)
        if kind < 0.75:
            return [value(level + 1) for _ in range(choose.randrange(4))]
        return {
            choose.choice(["a", "b", "x y", "true", "a:b", "1"]): value(level + 1)
            for _ in range(choose.randrange(4))
        }

    assert sum(written("a", value(0)) is not None for _ in range(1500)) > 300


def test_long_line_is_left_to_ruamel():
    assert written("md", [0.1 * k for k in range(200)]) is not None
    assert written("md", [0.1 * k for k in range(900)]) is None
