"""All outputs of the program, by file and in the order of its columns.

Plots, tables, the schema and the manual read this page.  It needs neither a model nor PETSc.
"""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output import quantities as measured
from drillpetsc.physics import quantities as physics


def outputs_by_file() -> dict[str, tuple[Quantity, ...]]:
    """Outputs of each file of a run folder, in the order of its columns or arrays."""
    components = (*physics.BIT, *physics.JOINTS, *physics.CONTACT)
    history = (
        *measured.ROW_START,
        *measured.TOP_END,
        *physics.BIT,
        *measured.LOWER_END,
        *measured.HOLE,
        *measured.MUD,
        *physics.JOINTS,
        *(q for q in components if q.on == "scalar" and q not in physics.BIT),
        *measured.ENERGY,
        *measured.ROW_END,
    )
    return {
        "history.csv": history,
        "probes.csv": (*measured.ROW_START, *measured.PROBES),
        "statics.csv": (
            measured.MD,
            measured.AXIAL_FORCE,
            measured.TORQUE,
            *_along_string(physics.CONTACT),
            measured.BENDING_MOMENT,
            measured.INCLINATION,
            measured.OFFSET_X,
            measured.OFFSET_Y,
            measured.CURVATURE,
            measured.BENDING_STRESS,
            measured.BUCKLING_LOAD,
            measured.BUCKLING_RATIO,
            *(q for q in measured.MUD_FIELDS if q.unit != "m/s"),
            measured.ECD,
            measured.EFFECTIVE_TENSION,
        ),
        "string/*.vtu": (
            *measured.STRING_FIELDS,
            *_along_string(components),
            measured.HOLE_RADIUS,
            *measured.MUD_FIELDS,
        ),
        "summary.json of statics": measured.STATIC_SUMMARY,
        "modes.csv": measured.MODES,
        "trajectory.csv": measured.TRAJECTORY,
    }


def _along_string(quantities: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
    return tuple(q for q in quantities if q.on in ("node", "element"))


def all_quantities() -> tuple[Quantity, ...]:
    """Every output once, in the order of files and columns."""
    return tuple({q.name: q for outputs in outputs_by_file().values() for q in outputs}.values())


def find(name: str) -> Quantity | None:
    """The output of this name (``x_600`` is ``x_NNN``), None where there is none."""
    return next((q for q in all_quantities() if q.matches(name)), None)


def label(name: str) -> str | None:
    """Words for the output of this name, with its depth; None where there is no such output."""
    q = find(name)
    if q is None:
        return None
    head, _, tail = q.name.partition("NNN")
    return q.label.replace("NNN", name[len(head) : len(name) - len(tail)])


def in_order(declared: list[tuple], file: str) -> list[tuple]:
    """(source, quantity) pairs in the order of a file's columns; what the catalogue does not list comes last."""
    place = {q.name: i for i, q in enumerate(outputs_by_file()[file])}
    return sorted(declared, key=lambda pair: place.get(pair[1].name, len(place)))
