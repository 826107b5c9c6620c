"""The command `completion`: commands, options and their words for the shell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

from drillpetsc.operations.operation import Mark, Operation

SCRIPT = """_drillpetsc() {{
  local words="" word=${{COMP_WORDS[COMP_CWORD]}}
  if [ "$COMP_CWORD" = 1 ]; then words="{commands}"; else
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
{choices}
      *) case "${{COMP_WORDS[1]}}" in
{options}
      esac;;
    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _drillpetsc drillpetsc scripts/drillpetsc"""


class Completion(Operation):
    """Print a script that completes commands and options in bash: eval "$(drillpetsc completion)"."""

    offered: ClassVar[Sequence[type[Operation]]] = ()
    """All operations; the package that lists them sets it."""

    def compute(self, job: Any) -> Any:
        options, choices = [], []
        for operation in self.offered:
            shown = [q for q in operation.options() if not {Mark.ARGUMENT, Mark.PYTHON} & set(q.marks)]
            options.append(
                f'        {operation.command()}) words="{" ".join(q.flag for q in shown)} --help";;'
            )
            choices += [
                f'      "{operation.command()} {q.flag}") words="{" ".join(map(str, q.choices))}";;'
                for q in shown
                if q.choices
            ]
        commands = " ".join(operation.command() for operation in self.offered)
        return SCRIPT.format(commands=commands, choices="\n".join(choices), options="\n".join(options))
