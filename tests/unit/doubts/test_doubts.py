"""Every doubt about a result: its sentence in all units, its values, its entry in the manual; and no warning outside the registry."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
import textwrap
from pathlib import Path
from string import Formatter

from drillpetsc.doubts import DOUBTS
from drillpetsc.doubts.doubt import Doubt, written
from drillpetsc.unit_systems import KINDS, SYSTEMS

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "docs"))
generate = importlib.import_module("generate")


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
            missing = [k for k in kinds if k in KINDS and KINDS[k].unit(units) not in text]
            if missing or ". " in text[-2:] or text.endswith("."):
                wrong.append((type(doubt).__name__, units, missing))
    assert wrong == []


def test_look_yields_the_values_of_the_sentence() -> None:
    """Of each doubt that yields dictionaries as they stand: all values of its sentence, and no other."""
    wrong, compared = [], 0
    for doubt in DOUBTS:
        tree = ast.parse(textwrap.dedent(inspect.getsource(type(doubt).look)))
        for node in ast.walk(tree):
            if isinstance(node, ast.Yield) and isinstance(node.value, ast.Dict):
                keys = [k.value for k in node.value.keys if isinstance(k, ast.Constant)]
                if len(keys) == len(node.value.keys):
                    compared += 1
                    if set(keys) != set(fields(doubt)):
                        wrong.append((type(doubt).__name__, set(keys) ^ set(fields(doubt))))
    assert wrong == [] and compared > 0.7 * len(DOUBTS)


def test_every_doubt_is_explained() -> None:
    page, names = generate.warnings_page(), [type(q).__name__ for q in DOUBTS]
    assert len(set(names)) == len(names)
    short = [
        type(q).__name__
        for q in DOUBTS
        if not (q.about and q.remedy.endswith(".") and len(inspect.getdoc(type(q)) or "") > 40)
        and q.weight == "warning"
    ]
    assert short == []
    assert [q for q in DOUBTS if f"> {generate.sentence_text(q.sentence)}" not in page] == []
