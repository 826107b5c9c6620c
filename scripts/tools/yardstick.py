"""The yardstick: drillpetsc and peers on the twelve neutral problems of cases/yardstick, and the scores of answers."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import yardstick_score as yard

PEERS = {
    "exudyn": ["exudyn==1.13.6"],
    "welleng": ["welleng==0.30.0"],
}  # answers of a peer come from yardstick_NAME.py, in an environment of its own
Answers = dict[str, dict[str, Any]]


def answer_with(solvers: dict[str, Any], names: list[str]) -> Answers:
    """Answers of a program: a function a problem; one that fails is told in a note and leaves its quantities open."""
    answers: Answers = {}
    for name in names:
        if isinstance(solvers[name], str):
            answers[name] = {"note": solvers[name]}
            continue
        start = time.perf_counter()
        try:
            found = dict(solvers[name](yard.load(name)))
        except Exception as error:
            found = {"note": f"failed: {type(error).__name__}: {error}"}
        answers[name] = {**found, "seconds": round(time.perf_counter() - start, 3)}
        print(f"{name}: {answers[name]['seconds']} s", file=sys.stderr)
    return answers


def run_peer(name: str, wanted: list[str], out: Path) -> None:
    """Install a peer into an environment of its own below the temporary folder, and write its answers."""
    folder = Path(tempfile.gettempdir()) / f"yardstick-{name}"
    python = folder / "bin" / "python"
    if not (folder / "ready").exists():
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(folder)], check=True)
        subprocess.run([python, "-m", "pip", "install", "-q", "numpy", "scipy", *PEERS[name]], check=True)
        (folder / "ready").touch()
    tool = Path(__file__).with_name(f"yardstick_{name}.py")
    clean = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONHOME")}
    subprocess.run([python, tool, out, *wanted], check=True, env=clean)


def write(answers: Answers, out: Path) -> None:
    """Write an answer file."""
    out.write_text(json.dumps(answers, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="scripts/yardstick", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    own = commands.add_parser("run", help="drillpetsc on all problems, or on those named")
    peers = commands.add_parser("peers", help=f"install and run {' and '.join(PEERS)}")
    for one, default in ((own, "drillpetsc.json"), (peers, ".")):
        one.add_argument("problem", nargs="*", help=", ".join(yard.ORDER))
        one.add_argument("--out", type=Path, default=Path(default), help="answer file, or folder of answer files")
    scored = commands.add_parser("score", help="errors and bands of answer files")
    scored.add_argument("answers", nargs="+", type=Path)
    scored.add_argument("--markdown", action="store_true", help="the table in Markdown")
    given = parser.parse_args()
    try:
        if given.command == "score":
            head, table = yard.rows(given.answers)
            print(yard.markdown(head, table) if given.markdown else yard.plain(head, table))
            print("\n" + "\n".join(f"- {line}" if given.markdown else line for line in yard.notes(given.answers)))
            return
        names = given.problem or list(yard.ORDER)
        for name in names:
            yard.load(name)
        if given.command == "run":
            import yardstick_drillpetsc as ours

            write(answer_with(ours.SOLVERS, names), given.out)
        else:
            for peer in PEERS:
                run_peer(peer, names, (given.out / f"{peer}.json").resolve())
    except ValueError as error:
        raise SystemExit(str(error)) from error


if __name__ == "__main__":
    main()
