"""Every doubt about a result: its sentence in all units, its values, its entry in the manual; and no warning outside the registry."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
from pathlib import Path
from string import Formatter

from drillpetsc.doubts.doubt import Doubt, written
from drillpetsc.unit_systems import KINDS, SYSTEMS, display_unit

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "docs"))
generate = importlib.import_module("generate")


DOUBTS = generate.all_doubts()
EXPLAINED = [q for q in DOUBTS if q.remedy]


def fields(doubt: Doubt) -> dict[str, str]:
    """Names and formats of the values of a sentence."""
    return {name: spec or "" for _, name, spec, _ in Formatter().parse(doubt.sentence) if name is not None}


def test_sentences_can_be_formed_in_all_units() -> None:
    wrong = []
    for doubt in DOUBTS:
        for units in SYSTEMS:
            values = {name: 2.0 if spec else "text" for name, spec in fields(doubt).items()}
            text = written(doubt.sentence, values, units)
            kinds = [spec.partition(" ")[0] for spec in fields(doubt).values()]
            missing = [k for k in kinds if k in KINDS and display_unit(k, units)[2] not in text]
            if missing or text.endswith("."):
                wrong.append((doubt.sentence, units, missing))
    assert wrong == []


def test_a_doubt_gives_the_values_of_its_sentence() -> None:
    """Of each doubt that yields or returns a dictionary as it stands: all values of its sentence, and no other."""
    wrong, compared = [], 0
    for doubt in EXPLAINED:
        tree = ast.parse(inspect.getsource(doubt.function))
        given = [node.value for node in ast.walk(tree) if isinstance(node, ast.Yield | ast.Return)]
        for value in (q.values[-1] if isinstance(q, ast.BoolOp) else q for q in given):
            if isinstance(value, ast.Dict):
                keys = [k.value for k in value.keys if isinstance(k, ast.Constant)]
                if len(keys) == len(value.keys):
                    compared += 1
                    if set(keys) != set(fields(doubt)):
                        wrong.append((doubt.function.__name__, set(keys) ^ set(fields(doubt))))
    assert wrong == [] and compared > 0.6 * len(EXPLAINED)


def test_every_doubt_is_explained() -> None:
    page, names = generate.warnings_page(), [q.function.__name__ for q in EXPLAINED]
    assert len(set(names)) == len(names)
    explained = [bool(q.about and q.remedy.endswith(".") and inspect.getdoc(q.function)) for q in EXPLAINED]
    assert [name for name, good in zip(names, explained, strict=True) if not good] == []
    assert [q.sentence for q in DOUBTS if f" {generate.sentence_text(q.sentence)}\n" not in page] == []


#: sentences that are still written where they are needed, by file: lists of assumptions of one command, and what a solver reports
OUTSIDE = {
    "analysis/hydraulics/hydraulics.py": 1,
    "analysis/calibration/log_series.py": 2,
    "analysis/loads/torque_drag/readings/calibrate.py": 6,
    "analysis/loads/torque_drag/operations.py": 10,
    "analysis/loads/torque_drag/roadmap.py": 2,
    "output/indices.py": 2,
}


def sentences_outside(source: str) -> int:
    """Number of texts that a module appends to a list named warnings or notes."""
    count = 0
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "append":
            name = getattr(node.func.value, "attr", getattr(node.func.value, "id", ""))
            texts = [
                q for q in ast.walk(node.args[0]) if isinstance(q, ast.Constant) and isinstance(q.value, str)
            ]
            count += name in ("warnings", "notes") and bool(texts)
    return count


def test_no_other_sentence_is_written_outside_the_registry() -> None:
    """A new doubt is a function; the exceptions may only become fewer."""
    package, found = ROOT / "drillpetsc", {}
    for layer in ("analysis", "output", "model", "physics", "solvers"):
        for file in (package / layer).rglob("*.py"):
            count = sentences_outside(file.read_text(encoding="utf-8"))
            if count:
                found[file.relative_to(package).as_posix()] = count
    assert {file: count for file, count in found.items() if count > OUTSIDE.get(file, 0)} == {}
    assert sentences_outside('warnings.append(f"{a} is wrong")\nnotes.append("b")\nlines.append("c")') == 2
