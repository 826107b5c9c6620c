"""The yardstick: drillpetsc on the twelve neutral problems of cases/yardstick, and the scores of answers."""

from __future__ import annotations

import argparse
from pathlib import Path

import yardstick_score as yard


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="scripts/yardstick", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    own = commands.add_parser("run", help="drillpetsc on all problems, or on those named")
    own.add_argument("problem", nargs="*", help=", ".join(yard.ORDER))
    own.add_argument("--out", type=Path, default=Path("drillpetsc.json"), help="answer file")
    scored = commands.add_parser("score", help="errors and bands of answer files")
    scored.add_argument("answers", nargs="+", type=Path)
    scored.add_argument("--markdown", action="store_true", help="the table in Markdown")
    given = parser.parse_args()
    try:
        if given.command == "score":
            head, table = yard.rows(given.answers)
            print(yard.markdown(head, table) if given.markdown else yard.plain(head, table))
            print(
                "\n"
                + "\n".join(f"- {line}" if given.markdown else line for line in yard.notes(given.answers))
            )
            return
        names = given.problem or list(yard.ORDER)
        for name in names:
            yard.load(name)
        import yardstick_drillpetsc as ours  # scores need neither drillpetsc nor PETSc
        from yardstick_common import answer_with, write

        write(answer_with(ours.SOLVERS, names), given.out)
    except (ValueError, OSError) as error:  # a file that is missing, is not JSON or names what is not asked
        raise SystemExit(f"yardstick: {error}") from error


if __name__ == "__main__":
    main()
