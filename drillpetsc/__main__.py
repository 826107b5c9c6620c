"""``python -m drillpetsc`` is the command line."""

from drillpetsc.cli import main

raise SystemExit(main())
