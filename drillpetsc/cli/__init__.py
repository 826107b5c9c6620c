"""The command line.

A command is one entry in the COMMANDS of the file of its subject, with its arguments and its handler beside it. Handlers
import what they need, so that no command waits for the imports of another.
"""

from drillpetsc.cli.commands import COMMANDS
from drillpetsc.cli.parser import RENAMED_OPTIONS, main, parser

__all__ = ["COMMANDS", "RENAMED_OPTIONS", "main", "parser"]
