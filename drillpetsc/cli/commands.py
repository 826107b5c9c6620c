"""The commands of the command line, in the order in which the help lists them."""

from __future__ import annotations

from drillpetsc.cli import analyses, cases, linear, pictures, runs

COMMANDS = (*runs.COMMANDS, *cases.COMMANDS, *analyses.COMMANDS, *linear.COMMANDS, *pictures.COMMANDS)
