"""``python -m drillpetsc.kernels build [FOLDER ...]`` compiles the kernels, or plug-ins, if needed and prints their location."""

import sys

from drillpetsc.kernels.build import main

if sys.argv[1:2] not in ([], ["build"]):
    raise SystemExit("usage: python -m drillpetsc.kernels build [FOLDER ...]")
try:
    main(sys.argv[2:])
except RuntimeError as error:
    raise SystemExit(str(error)) from None
