"""All outputs of the program, by file and in the order of its columns, each with the condition under which it exists.

Plots, tables, the manual and ``drillpetsc schema --outputs`` read this page.  It does not need a model or PETSc.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

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
    TIME,
    TOP_END,
    TOP_TRAVEL,
)
from drillpetsc.output.quantities.mud import BORE_ONLY, MUD, MUD_FIELDS, SIDE_FLOW
from drillpetsc.output.quantities.probes import PROBES, SIDE_FORCES
from drillpetsc.output.quantities.tables import COLUMNS
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
    return _of_motion() | _of_states() | _of_commands()


def _mud_at_ends() -> tuple[Listed, ...]:
    """Pressures and flow rates at the ends of the mud's channels."""
    return (
        *_listed(MUD, where.MUD, **dict.fromkeys(BORE_ONLY, where.BORE)),
        *_listed((SIDE_FLOW,), where.SIDE_NOZZLES),
    )


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
            *_mud_at_ends(),
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
        "sensors/*.csv": _listed(
            COLUMNS["sensors"],
            where.CHANNEL,
            time="",
            internal_pressure=f"{where.CHANNEL}, {where.BORE}",
            annulus_pressure=f"{where.CHANNEL}, {where.ANNULUS}",
            **dict.fromkeys(
                ("ax_motion", "ay_motion", "az_motion", "spin_acceleration"),
                f"{where.CHANNEL}, {where.INDICES}",
            ),
        ),
        "indices.csv": (
            *_listed((TIME, *COLUMNS["window"])),
            *_listed(COLUMNS["rotation"], where.STRING),
            *_listed(COLUMNS["drilling"], where.CAN_DRILL, efficiency=f"{where.CAN_DRILL}, bit_law drag_bit"),
            *_listed(COLUMNS["whirl"], "probes and a hole"),
            *_listed(COLUMNS["of_sensor"], where.SENSOR),
        ),
    }


def _of_states() -> dict[str, tuple[Listed, ...]]:
    """Files of a state: along the string, and the summary of statics."""
    along_string = (
        *_listed(_along_string(physics.BIT), where.BIT),
        *_listed(_along_string(physics.JOINTS), where.JOINTS),
        *_listed(_along_string(physics.CONTACT), where.CONTACT),
    )
    mud_fields = tuple(
        Listed(q, where.BORE if q.name.startswith("internal") else where.ANNULUS) for q in MUD_FIELDS
    )
    return {
        "statics.csv": _listed(
            COLUMNS["statics"],
            where.STRING,
            md="",
            internal_pressure=where.BORE,
            internal_flow=where.BORE,
            annulus_pressure=where.ANNULUS,
            annulus_flow=where.ANNULUS,
            ecd=where.ANNULUS,
            effective_tension=where.MUD_AND_STRING,
        ),
        "string/*.vtu": (
            *_listed(
                STRING_FIELDS,
                where.STRING,
                md="",
                outer_radius="",
                slope=where.SLOPES,
                stress=where.TUBES,
                effective_tension=where.MUD_AND_STRING,
            ),
            *along_string,
            *_listed((HOLE_RADIUS,), where.WELL),
            *mud_fields,
        ),
        "summary.json of statics": (
            *_listed(
                COLUMNS["static_summary"], where.STRING, hook_load_total=where.BLOCK, top_travel=where.TOP
            ),
            *_mud_at_ends(),
            *_listed(COLUMNS["ecd"], where.ANNULUS),
        ),
    }


def _of_commands() -> dict[str, tuple[Listed, ...]]:
    """Files of the other commands."""
    return {
        "modes.csv": (*_listed(COLUMNS["modes"]), *_listed(COLUMNS["stokes_number"], where.STOKES)),
        "campbell.csv": _listed(COLUMNS["campbell"]),
        "critical.csv": _listed(COLUMNS["critical"]),
        "critical_map.csv": _listed(COLUMNS["critical_map"], where.STIFFNESS),
        "stability_map.csv": _listed(COLUMNS["stability_map"]),
        "stability_boundary.csv": _listed(COLUMNS["stability_boundary"]),
        "stability_runs.csv": _listed(COLUMNS["stability_runs"]),
        "response.csv": (*_listed(COLUMNS["response"]), *_listed(COLUMNS["response_stress"], where.STRESS)),
        "reflection.csv": _listed(COLUMNS["reflection"]),
        "trajectory.csv": _listed(COLUMNS["trajectory"]),
        "hydraulics.csv": _listed(COLUMNS["loss_rows"]),
        "nozzles.csv": _listed(COLUMNS["nozzles"], where.SIDE_NOZZLES),
        "pressure_profile.csv": _listed(COLUMNS["pressure_profile"]),
        "flow_curve.csv": _listed(COLUMNS["flow_curve"]),
        "dial_readings.csv": _listed(COLUMNS["dial_readings"], where.DIAL),
        "rheology_fits.csv": _listed(COLUMNS["rheology_fits"], where.DIAL),
        "summary.json of hydraulics": _listed(COLUMNS["hydraulics_summary"]),
        "surge.csv": _listed(
            (*COLUMNS["surge"], *COLUMNS["side_surge"], *COLUMNS["dynamic_surge"]),
            side_flow=where.SIDE_NOZZLES,
            **dict.fromkeys((q.name for q in COLUMNS["dynamic_surge"]), "with `--dynamic`"),
        ),
        "max_trip_speed.csv": _listed(COLUMNS["max_trip_speed"]),
        "calibration.csv": _listed(COLUMNS["measured"]),
        "calibration_series.csv": _listed((TIME, *COLUMNS["calibration_series"])),
        "measured.csv": _listed(COLUMNS["beside"]),
        "roadmap.csv": _listed(
            COLUMNS["roadmap"],
            hook_load_total=where.BLOCK,
            hook_load_reading=where.DEAD_LINE,
            ff_groups=where.GROUPS,
        ),
        "sensitivities.csv": _listed(COLUMNS["sensitivities"]),
        "sensitivities_history.csv": _listed((TIME, *COLUMNS["sensitivities_over_time"])),
        "uncertain.csv": _listed(COLUMNS["uncertain"]),
        "uncertain_limits.csv": _listed(COLUMNS["uncertain_limits"]),
        "uncertain_shares.csv": _listed(COLUMNS["uncertain_shares"]),
        "limits.csv": _listed(
            COLUMNS["limits"], damage_per_hour="with `--sn`", casing_wear_rate="string that turns in a casing"
        ),
        "contacts.csv": _listed(COLUMNS["contacts"]),
    }


def _listed(quantities: tuple[Quantity, ...], condition: str = "", **others: str) -> tuple[Listed, ...]:
    """Quantities with their condition.  others: conditions of single quantities, by name."""
    return tuple(Listed(q, others.get(q.name, condition)) for q in quantities)


def _along_string(quantities: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
    return tuple(q for q in quantities if q.on in ("node", "element"))


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
