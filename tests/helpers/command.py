"""The command line from a test: in this process, or in one of its own if the test is about the process."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, nullcontext, redirect_stderr, redirect_stdout
from io import BytesIO, StringIO
from pathlib import Path
from subprocess import CompletedProcess

import pytest
from petsc4py import PETSc

from drillpetsc.cli.parser import main, split_words

ROOT = Path(__file__).parents[2]
#: of processes that a test starts: this tree's package, on one thread
ENVIRONMENT = {
    "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")])),
    "OMP_NUM_THREADS": "1",
}


@contextmanager
def unrendered() -> Iterator[None]:
    """Compose pictures, but do not render them, which takes longer than most commands: their files are empty."""
    from matplotlib.figure import Figure

    from drillpetsc.plotting.notebook import Picture

    def touched(figure: Figure, file: str | Path | BytesIO, **options: object) -> None:
        if isinstance(file, str | Path):
            Path(file).touch()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Picture, "fitted", lambda picture, *place, **more: picture)
        patch.setattr(Figure, "savefig", touched)
        yield


def drillpetsc(line: object, *more: object, cwd: Path, rendered: bool = False) -> CompletedProcess[str]:
    """Run a command line in the folder ``cwd``, in this process: a start takes longer than most commands.

    line: words as in a shell; more: further words, each as it is. PETSc has started already, so its options are set here,
    and are gone afterwards. An exception that the program does not catch is raised.
    rendered: with pictures that can be looked at.
    """
    words, out, err = _words(line, *more), StringIO(), StringIO()
    database = PETSc.Options()
    before = database.getAll()
    database.insertString(" ".join(split_words(words)[1]))
    try:
        with (
            nullcontext() if rendered else unrendered(),
            chdir(cwd),
            redirect_stdout(out),
            redirect_stderr(err),
        ):
            status = main(words)
    except SystemExit as end:  # argparse: --help, or a bad word
        status = int(end.code or 0)
    finally:
        for name in database.getAll():
            database.delValue(name)
        for name, value in before.items():
            database.setValue(name, value)
    return CompletedProcess(words, status, out.getvalue(), err.getvalue())


def succeeds(line: object, *more: object, cwd: Path, rendered: bool = False) -> CompletedProcess[str]:
    """The same of a command line that ends with status 0."""
    done = drillpetsc(line, *more, cwd=cwd, rendered=rendered)
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def main_succeeds(*words: object, rendered: bool = False) -> None:
    """The words in the present folder, with what they print left to pytest; they end with status 0."""
    with nullcontext() if rendered else unrendered():
        assert main([str(word) for word in words]) == 0


def _words(line: object, *more: object) -> list[str]:
    return [*shlex.split(str(line)), *map(str, more)]


def in_own_process(line: object, *more: object, cwd: Path, **options: object) -> CompletedProcess[str]:
    """The same as a user starts it.  options: of ``subprocess.run``, instead of pipes for both outputs."""
    return python("-m", "drillpetsc", *_words(line, *more), cwd=cwd, **options)


def python(*words: str, **options: object) -> CompletedProcess[str]:
    """Run ``python words``.  options: of ``subprocess.run``, instead of pipes for both outputs."""
    line, environment = [sys.executable, *words], os.environ | ENVIRONMENT
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.run(line, text=True, timeout=300, env=environment, **(pipes | options))  # type: ignore[call-overload]
