"""The manual: every command, case and Python block that it shows works as it stands."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.helpers.command import drillpetsc
from tests.helpers.mpi import have_mpi

ROOT = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("extract", ROOT / "docs" / "extract.py")
assert spec is not None and spec.loader is not None
extract = importlib.util.module_from_spec(spec)
spec.loader.exec_module(extract)
PAGES = {str(page.relative_to(ROOT / "docs")): page for page in extract.pages()}


def environment() -> dict[str, str]:
    """Without the marks that MPI leaves in this process; one thread."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PMIX", "PMI_", "PRTE_", "OMPI_"))}
    beside = str(Path(sys.executable).parent)
    path = os.pathsep.join([beside, kept.get("PATH", "")])
    source = os.pathsep.join(filter(None, [str(ROOT), kept.get("PYTHONPATH")]))
    root = {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
    }
    return kept | root | {"PATH": path, "PYTHONPATH": source, "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg"}


#: long motions are cut short: where they lead is no part of these tests
SHORTER = {
    "end: 7200 s": "end: 400 s",
    "end: 300 s": "end: 20 s",
    "end: 60 s": "end: 15 s",
    "end: 20 s": "end: 4 s",
    "time.end=30": "time.end=6",
    "time.end=12": "time.end=4",
}


def shorter(text: str) -> str:
    for long, short in SHORTER.items():
        text = text.replace(long, short)
    return text


NUMBER = re.compile(r"[-+]?\d[\d.,]*(?:e[-+]?\d+)?")


def words(line: str) -> str:
    """A line of output with `#` for its numbers, which depend on the machine or on how long a motion is cut."""
    return " ".join(NUMBER.sub("#", line).split())


def not_printed(lines: list[str], output: str) -> list[str]:
    """The shown lines, with `...` for what is left out, whose words are not in the output of their command."""
    printed = {words(line) for line in output.splitlines()}
    return [
        line
        for line in lines
        if not any(re.fullmatch(re.escape(words(line)).replace(r"\.\.\.", ".*"), text) for text in printed)
        and line.strip() != "..."
    ]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with `cases/` of the project, whose motions are cut short."""
    (cases := tmp_path / "cases").mkdir()
    for path in (ROOT / "cases").iterdir():
        if path.suffix == ".yaml" and (text := path.read_text()) != shorter(text):
            (cases / path.name).write_text(shorter(text))
        else:
            (cases / path.name).symlink_to(path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, page in PAGES.items() if extract.commands(page)])
def test_commands_of_the_manual_run(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = PAGES[name]
    for case in sorted((ROOT / "docs" / "tutorials" / "cases").glob("*.yaml")):
        (folder / case.name).write_text(shorter(case.read_text()))
    for file, text in extract.cases(page).items():
        (folder / file).write_text(shorter(text))
    monkeypatch.setenv("MPLBACKEND", "Agg")
    # launcher: words of its commands, which one start runs in turn, and what the page shows of them
    in_parallel: dict[str, list[tuple[list[str], list[str]]]] = {}
    for command, lines in extract.shown(page):
        if command.startswith(("scripts/", "sudo", "apt", "git", "pip", "cd ")):
            continue  # set-up, which scripts/test itself has done
        launcher, _, line = f" {shorter(command)}".partition(" drillpetsc ")
        if launcher:
            in_parallel.setdefault(launcher, []).append((shlex.split(line), lines))
            continue
        done = drillpetsc(line, cwd=folder)
        assert done.returncode == 0, f"{command}\n{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
        assert not not_printed(lines, done.stdout + done.stderr), command
    if in_parallel and not have_mpi():
        pytest.skip("no mpirun")
    for launcher, commands in in_parallel.items():
        (folder / "lines.json").write_text(json.dumps([command for command, _ in commands]))
        program = [sys.executable, "-P", str(ROOT / "tests" / "parallel" / "run_commands.py"), "lines.json"]
        start = [*shlex.split(launcher), *program]
        done = subprocess.run(
            start, cwd=folder, env=environment(), capture_output=True, text=True, timeout=600
        )
        assert done.returncode == 0, f"{launcher}\n{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
        assert not not_printed([line for _, lines in commands for line in lines], done.stdout + done.stderr)


def test_a_line_that_a_command_does_not_print_is_found() -> None:
    output = "  hook load   12.5 kN\n  stable; 8 Newton iterations, residual 1e-5 N\n"
    assert not not_printed(["  hook load   -3e-2 kN", "...", "  stable; 7 Newton ..."], output)
    assert not_printed(["  hook load  12.5 klbf"], output) == ["  hook load  12.5 klbf"]


EXTRA = "# needs drillpetsc[notebook]"  # first line of blocks that use xarray or pandas


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [name for name in PAGES if name.startswith("tutorials/") and extract.blocks(PAGES[name], "python")],
)
def test_python_of_the_tutorials_runs(name: str, folder: Path) -> None:
    """Blocks that do not need xarray and pandas without them, and then the others."""
    blocks = extract.blocks(PAGES[name], "python")
    needy = [block for block in blocks if block.startswith(EXTRA)]
    blocks = [
        "import sys\nsys.modules['xarray'] = sys.modules['pandas'] = None\n",
        *(block for block in blocks if block not in needy),
    ]
    extra = all(map(importlib.util.find_spec, ("xarray", "pandas")))
    if extra:
        blocks += ["del sys.modules['xarray'], sys.modules['pandas']", *needy]
    line = [sys.executable, "-P", "-c", "\n".join(blocks)]
    done = subprocess.run(line, cwd=folder, env=environment(), capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
    if needy and not extra:
        pytest.skip("without xarray and pandas")


@pytest.mark.parametrize("name", [name for name, page in PAGES.items() if extract.fragments(page)])
def test_blocks_of_the_manual_are_valid(name: str) -> None:
    from drillpetsc.case import Case

    for fragment in extract.fragments(PAGES[name]):
        data = yaml.safe_load(fragment)
        if isinstance(data, dict):
            Case(**extract.with_fragment(data))


def test_no_page_without_commands_hides_in_the_list() -> None:
    """The tests above see the pages: the tutorials all show commands."""
    assert (
        sum(bool(extract.commands(page)) for name, page in PAGES.items() if name.startswith("tutorials/"))
        >= 9
    )
