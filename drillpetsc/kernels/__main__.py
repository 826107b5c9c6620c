"""``python -m drillpetsc.kernels build`` compiles the kernels if needed and prints their location."""

import sys

from drillpetsc.kernels.build import main

if sys.argv[1:] not in ([], ["build"]):
    raise SystemExit("usage: python -m drillpetsc.kernels build")
main()
