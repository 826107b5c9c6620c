"""drillpetsc: drillstring dynamics on PETSc.

The public face is that of `drillpetsc.api`: `Case` describes what is simulated (the keys of a case file),
`DrillPipe`, `HWDP`, `DrillCollar`, `Stabilizer`, `Bit` and others are the items of its string, `load_case` reads one, `run`, `sweep`,
`statics`, `hydraulics`, `surge`, `roadmap`, `calibrate`, `import_log`, `limits`, `freepoint`, `modes`, `campbell`, `stability`, `response`,
`top_drive` and `study` are the commands, `Session` advances a model step by step, and `open_run` reads the results of a command
again. `units` converts values; `vibration` has the functions of drilling dynamics on series of numbers.
Importing the package starts no MPI and imports nothing else of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drillpetsc.analysis.motion.session.session import Session
    from drillpetsc.api import (
        HWDP,
        Agitator,
        Beam,
        Bit,
        Body,
        BumperSub,
        Case,
        CaseError,
        Casing,
        CoiledTubing,
        DrillCollar,
        DrillPipe,
        Jar,
        MudMotor,
        Pipe,
        Reamer,
        RotarySteerable,
        ShockSub,
        SolveError,
        Stabilizer,
        Tool,
        calibrate,
        campbell,
        catalogue,
        fmu,
        freepoint,
        hydraulics,
        import_log,
        limits,
        linearise,
        load_case,
        modes,
        mud_motor,
        open_run,
        response,
        roadmap,
        run,
        stability,
        statics,
        study,
        surge,
        sweep,
        top_drive,
    )

from drillpetsc.version import __version__ as __version__

__all__ = [
    "Agitator",
    "Beam",
    "Bit",
    "Body",
    "BumperSub",
    "Case",
    "CaseError",
    "Session",
    "Casing",
    "CoiledTubing",
    "DrillCollar",
    "DrillPipe",
    "HWDP",
    "Jar",
    "MudMotor",
    "Pipe",
    "Reamer",
    "RotarySteerable",
    "ShockSub",
    "SolveError",
    "Stabilizer",
    "Tool",
    "calibrate",
    "campbell",
    "catalogue",
    "fmu",
    "freepoint",
    "hydraulics",
    "import_log",
    "limits",
    "linearise",
    "load_case",
    "modes",
    "mud_motor",
    "open_run",
    "response",
    "run",
    "stability",
    "statics",
    "study",
    "roadmap",
    "surge",
    "sweep",
    "top_drive",
]


def __getattr__(name: str) -> Any:
    """Import the public face when one of its names is used."""
    if name in ("units", "vibration"):
        return import_module(f"drillpetsc.{name}")
    if name == "Session":
        return import_module("drillpetsc.analysis.motion.session.session").Session
    if name in __all__:
        return getattr(import_module("drillpetsc.api"), name)
    raise AttributeError(f"module 'drillpetsc' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
