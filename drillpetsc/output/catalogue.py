"""All outputs of the program, by file and in the order of its columns, each with the condition under which it exists.

Plots, tables, the manual and ``drillpetsc schema --outputs`` read this page.  It does not need a model or PETSc.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import starmap

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output import conditions as where
from drillpetsc.output.quantities.along_string import HOLE_RADIUS, STRING_FIELDS
from drillpetsc.output.quantities.history import (
    ENERGY,
    HOLE,
    HOOK_LOAD_TOTAL,
    LOWER_END,
    ROW_END,
    ROW_START,
    TOP_END,
    TOP_TRAVEL,
)
from drillpetsc.output.quantities.mud import BORE_ONLY, MUD, MUD_FIELDS, SIDE_FLOW
from drillpetsc.output.quantities.probes import PROBES, SIDE_FORCES
from drillpetsc.output.quantities.tables import CONDITIONS
from drillpetsc.output.summary_keys import SUMMARY_KEYS
from drillpetsc.physics import quantities as physics
from drillpetsc.unit_systems import System


@dataclass(frozen=True)
class Listed:
    """A quantity in a file.

    condition: what the case must contain for the file to have the quantity; empty: always.
    """

    quantity: Quantity
    condition: str


@cache
def listed_by_file() -> dict[str, tuple[Listed, ...]]:
    """Quantities of each file of a run folder with their conditions, in the order of its columns or arrays."""
    of_tables = {
        file: tuple(starmap(Listed, columns.items()))
        for file, columns in CONDITIONS.items()
        if file.endswith(".csv") or file.startswith("summary.json")
    }
    along_time = {file: of_tables[file] for file in ("sensors/*.csv", "indices.csv", "statics.csv")}
    return _of_motion() | along_time | {"string/*.vtu": _along_string()} | of_tables


def _of_motion() -> dict[str, tuple[Listed, ...]]:
    """Files of numbers over time."""
    contact_scalars = tuple(q for q in physics.CONTACT if q.on == "scalar")
    return {
        "history.csv": (
            *_listed(ROW_START),
            *_listed(TOP_END, where.TOP),
            *_listed((HOOK_LOAD_TOTAL,), where.BLOCK),
            *_listed(physics.TOP_MOTOR, where.MOTOR),
            *_listed((TOP_TRAVEL,), where.MOVING_TOP),
            *_listed(physics.HOIST, where.HOIST),
            *_listed(physics.AUTODRILLER, where.AUTODRILLER),
            *_listed(physics.BIT, where.BIT),
            *_listed(physics.BIT_SIDE, where.CUTS_SIDE),
            *_listed(physics.REAMER, where.REAMS),
            *_listed(physics.STEERING_PUSH[:1], where.PUSHES),
            *_listed(physics.STEERING_POINT[:1], where.POINTS),
            *_listed(physics.STEERING_PUSH[1:], where.STEERS),
            *_listed(LOWER_END, where.STRING),
            *_listed(HOLE, where.BIT, rop=where.DRILLS),
            *_listed(MUD, where.MUD, **dict.fromkeys(BORE_ONLY, where.BORE)),
            *_listed((SIDE_FLOW,), where.SIDE_NOZZLES),
            *_listed(physics.JOINTS, where.JOINTS),
            *_listed(physics.MUD_MOTOR, where.MUD_MOTOR),
            *_listed(physics.JAR, where.JAR),
            *_listed(physics.AGITATOR, where.AGITATOR),
            *_listed(contact_scalars, where.CONTACT),
            *_listed(SIDE_FORCES, where.ITEM_FORCES),
            *_listed(ENERGY, where.INERTIA),
            *_listed(ROW_END),
        ),
        "probes.csv": (
            *_listed(ROW_START),
            *_listed(PROBES, contact_NNN=where.CONTACT),
        ),
    }


def _along_string() -> tuple[Listed, ...]:
    """Arrays of the frames of the string."""
    conditions = {
        "md": "",
        "outer_radius": "",
        "slope": where.SLOPES,
        "stress": where.TUBES,
        "effective_tension": where.MUD_AND_STRING,
    }
    along = (
        *_listed(physics.BIT, where.BIT),
        *_listed(physics.JOINTS, where.JOINTS),
        *_listed(physics.CONTACT, where.CONTACT),
    )
    return (
        *_listed(STRING_FIELDS, where.STRING, **conditions),
        *(entry for entry in along if entry.quantity.on in ("node", "element")),
        *_listed((HOLE_RADIUS,), where.WELL),
        *(Listed(q, where.BORE if q.name.startswith("internal") else where.ANNULUS) for q in MUD_FIELDS),
    )


def _listed(quantities: tuple[Quantity, ...], condition: str = "", **others: str) -> tuple[Listed, ...]:
    """Quantities with their condition.  others: conditions of single quantities, by name."""
    return tuple(Listed(q, others.get(q.name, condition)) for q in quantities)


@cache
def outputs_by_file() -> dict[str, tuple[Quantity, ...]]:
    """Outputs of each file of a run folder, in the order of its columns or arrays."""
    return {file: tuple(entry.quantity for entry in entries) for file, entries in listed_by_file().items()}


def tables() -> list[str]:
    """Names of the tables in a run folder."""
    return [file for file in outputs_by_file() if file.endswith(".csv") and "/" not in file]


def records() -> list[dict[str, str]]:
    """Every output and key of the files of a run folder, as texts, printed by ``drillpetsc schema --outputs``.

    ``condition`` is empty for quantities in every such file; ``label``, ``mnemonic`` and ``sign`` are empty for keys of
    summary.json that are not quantities.
    """
    described = listed_by_file()
    out: list[dict[str, str]] = []
    for file in dict.fromkeys([*described, *SUMMARY_KEYS]):
        for entry in described.get(file, ()):
            q = entry.quantity
            texts = (file, q.name, q.unit, q.label, q.mnemonic, q.sign, q.doc, entry.condition)
            out.append(dict(zip(RECORD, texts, strict=True)))
        for key in SUMMARY_KEYS.get(file, ()):
            texts = (file, key.name, key.unit, "", "", "", key.doc, key.condition)
            out.append(dict(zip(RECORD, texts, strict=True)))
    return out


#: entries of a record
RECORD = ("file", "name", "unit", "label", "mnemonic", "sign", "doc", "condition")


@cache
def all_quantities() -> tuple[Quantity, ...]:
    """Every output once, in the order of files and columns."""
    return tuple({q.name: q for outputs in outputs_by_file().values() for q in outputs}.values())


@cache
def find(name: str) -> Quantity | None:
    """The output of this name (``x_600`` is ``x_NNN``), None if there is none."""
    return next((q for q in all_quantities() if q.matches(name)), None)


def label(name: str, system: System = "SI") -> str | None:
    """Words for the output of this name, with its depth in a system of units; None if there is no such output."""
    q = find(name)
    return None if q is None else q.label_at(q.place(name) or "", system)


def in_order(declared: list[tuple], file: str) -> list[tuple]:
    """(source, quantity) pairs in the order of a file's columns; what the catalogue does not list comes last."""
    listed = outputs_by_file()[file]
    place = {q.name: i for i, q in enumerate(listed)}

    def order(pair: tuple) -> int:
        name = pair[1].name
        if name in place:
            return place[name]
        return next((i for i, q in enumerate(listed) if q.tool and q.matches(name)), len(place))

    return sorted(declared, key=order)
