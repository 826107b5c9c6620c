"""The command line, made from the classes of `drillpetsc.operations`."""

from drillpetsc.cli.parser import main, parser

__all__ = ["main", "parser"]
