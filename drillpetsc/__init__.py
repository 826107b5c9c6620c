"""drillpetsc: drillstring dynamics on PETSc.

The public face is that of `drillpetsc.api`: `Case` describes what is simulated (the keys of a case file),
`DrillPipe`, `Bit`, `Well`, `TopDrive`, `Fluid` and others are its blocks, `load_case` reads one, `run`, `sweep`,
`statics`, `hydraulics`, `surge`, `roadmap`, `calibrate`, `limits`, `freepoint`, `sensitivities`, `modes`, `campbell`, `stability`, `response`,
`top_drive` and `study` are the commands, `Session` advances a model step by step, and `open_run` reads the results of a command
again. `units` converts values; `vibration` has the functions of drilling dynamics on series of numbers.
Importing the package starts no MPI and imports nothing else of it. The types of the public names are in `__init__.pyi`.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from drillpetsc.version import __version__ as __version__


def __getattr__(name: str) -> Any:
    """Import the public face when one of its names is used."""
    if name in ("units", "vibration"):
        return import_module(f"drillpetsc.{name}")
    if name == "Session":
        return import_module("drillpetsc.analysis.motion.session.session").Session
    # `from drillpetsc import operations` asks here before it loads the module: the help would wait for all of the face
    own = name.startswith("_") or find_spec(f"drillpetsc.{name}") is not None
    public = {} if own else import_module("drillpetsc.api").PUBLIC
    if name in public:
        return public[name]
    raise AttributeError(f"module 'drillpetsc' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*import_module("drillpetsc.api").PUBLIC, "Session", "__version__", "units", "vibration"])
