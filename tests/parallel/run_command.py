"""The command line: run_command.py COMMAND [ARGUMENTS]."""

import sys

from drillpetsc.cli import main

raise SystemExit(main(sys.argv[1:]))
