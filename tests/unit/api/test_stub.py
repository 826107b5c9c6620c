"""Types of the public names: the stub follows from blocks and commands, and a type checker finds wrong keys with it."""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import drillpetsc as dp
from drillpetsc.api import PUBLIC
from drillpetsc.api.stub import STUB, stub, type_of
from tests.helpers.tables import each_row

GOOD = """
from pathlib import Path
import drillpetsc as dp

case = dp.Case(
    units="field",
    string=[
        dp.DrillPipe("5in 19.50 S-135 NC50 premium", length=9000),
        dp.DrillCollar(length="180 ft", od="6 3/4 in", id=2.8125),
        {"kind": "bit", "length": 1.0, "od": 8.5},
    ],
    well=dp.Well(
        survey=dp.Survey(md=[0, 9500], inclination=[0, 0], azimuth=[0, 0]),
        sections=[dp.Section(to=9500, kind="open_hole", diameter=8.5)],
    ),
    top=dp.TopDrive(rotation="120 rpm"),
    fluid=dp.Fluid(density=10.0, rheology=dp.PowerLaw(consistency="0.5 Pa s^n", index=0.7)),
)
result = dp.statics(case, "out", operation="trip_in", overwrite=True)
print(result.summary, dp.run(case, Path("r"), progress="silent").history, case.string_length)
dp.sweep(case, {"fluid.density": [9.0, 10.0]}, restart=True)
"""
WRONG = {
    "key": ("dp.Fluid(density=1.0, rheologie={})", "rheologie"),
    "missing": ("dp.Well(sections=[])", "survey"),
    "word": ("dp.Section(to=1.0, kind='openhole', diameter=0.2)", "openhole"),
    "type": ("dp.DrillPipe(length=[1.0])", "length"),
    "block": (
        "dp.Case(string=[], fluid=dp.Well(survey=dp.Survey(md=[], inclination=[], azimuth=[]), sections=[]))",
        "fluid",
    ),
    "keyword": ("dp.run('case.yaml', over_write=True)", "over_write"),
    "operation": ("dp.limits('case.yaml', helical=3)", "helical"),
}


def test_the_stub_is_up_to_date() -> None:
    """When this fails: python -m drillpetsc.api.stub."""
    assert STUB.read_text(encoding="utf-8") == stub()


def test_the_stub_has_every_public_name() -> None:
    text = STUB.read_text(encoding="utf-8")
    for name, thing in PUBLIC.items():
        kind = "class" if inspect.isclass(thing) and name not in ("CaseError", "SolveError") else "def"
        assert f"{kind} {name}(" in text or f" {name} as {name}" in text, name
    assert set(PUBLIC) < set(dir(dp))


@each_row(
    ("schema", "types"),
    [
        ({"anyOf": [{"type": "number"}, {"type": "string"}, {"type": "null"}]}, "Value | None"),
        ({"type": "array", "items": {"type": "string"}}, "Sequence[str]"),
        ({"enum": ["a", "b"]}, "Literal['a', 'b']"),
        ({"oneOf": [{"$ref": "#/$defs/HeavyPipe"}, {"const": "x"}]}, "HWDP | dict[str, Any] | Literal['x']"),
    ],
)
def test_types_of_values(schema: dict[str, object], types: str) -> None:
    assert " | ".join(type_of(schema)) == types


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What mypy says of a right script and of wrong lines, one run for all."""
    folder = tmp_path_factory.mktemp("scripts")
    (folder / "good.py").write_text(GOOD, encoding="utf-8")
    lines = "\n".join(f"{line}  # {name}" for name, (line, _) in WRONG.items())
    (folder / "wrong.py").write_text("import drillpetsc as dp\n" + lines + "\n", encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--ignore-missing-imports"]
    command += ["--config-file=", f"--cache-dir={folder}/cache", "good.py", "wrong.py"]
    root = str(Path(dp.__file__).parents[1])
    environment = {"MYPYPATH": root, "PATH": "/usr/bin:/bin"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    return done.stdout + done.stderr


def test_a_right_script_passes(found: str) -> None:
    assert "wrong.py" in found and "good.py" not in found, found


@each_row("name", list(WRONG))
def test_a_type_checker_finds_what_is_wrong(found: str, name: str) -> None:
    line = 2 + list(WRONG).index(name)
    said = [text for text in found.splitlines() if text.startswith(f"wrong.py:{line}:") and "error" in text]
    assert any(WRONG[name][1] in text or "incompatible type" in text for text in said), found
