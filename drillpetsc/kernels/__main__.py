"""``python -m drillpetsc.kernels build`` compiles the kernels if needed and prints where they are."""

import sys

from drillpetsc.kernels.build import build, check_trusted

if sys.argv[1:] not in ([], ["build"]):
    raise SystemExit("usage: python -m drillpetsc.kernels build")
path = build()
check_trusted(path)
print(path)
