"""Sections on results: the tables and the summary of run folders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.case.blocks.well import OTHER_FITS
from drillpetsc.output import catalogue
from drillpetsc.output.files.run_folder import INDICES_TABLE, RunFolder
from drillpetsc.output.files.tables import read_table, split_name
from drillpetsc.output.shown_units import key_unit
from drillpetsc.output.summary_keys import SUMMARY_KEYS
from drillpetsc.plotting import style
from drillpetsc.plotting.run.plot import drawings
from drillpetsc.reporting.page import MIXED, Grid, Section, facts, file_grid, picture
from drillpetsc.reporting.units import heading_of, in_units, label_of, number, texts, unit_of
from drillpetsc.unit_systems import System

LEAST_SHARE = 1e-4  # smallest error that is reported, as a share


@dataclass(frozen=True)
class Kind:
    """A kind of results.

    key: of its section; tables: files in the run folder that hold it, the first one always; pictures: their names;
    command: that computes it, empty if no single one does; columns: of the first table that are shown, by default all; needs_mud.
    """

    key: str
    title: str
    tables: tuple[str, ...]
    pictures: tuple[str, ...]
    command: str
    columns: tuple[str, ...] = ()
    needs_mud: bool = False


ALONG = (
    "md",
    "axial_force",
    "effective_tension",
    "torque",
    "contact_force",
    "bending_moment",
    "inclination",
    "bending_stress",
    "buckling_ratio",
    "ecd",
)
KINDS = (
    Kind(
        "roadmap",
        "Torque and drag",
        ("roadmap.csv", "calibration.csv", "calibration_series.csv"),
        ("roadmap", "calibration"),
        "roadmap CASE.yaml",
    ),
    Kind("statics", "Statics", ("statics.csv",), ("along_depth",), "statics CASE.yaml", ALONG),
    Kind("limits", "Limits", ("limits.csv", "contacts.csv"), ("limits", "contacts"), "limits CASE.yaml"),
    Kind(
        "hydraulics",
        "Hydraulics",
        (
            "hydraulics.csv",
            "nozzles.csv",
            "pressure_profile.csv",
            "flow_curve.csv",
            "dial_readings.csv",
            "rheology_fits.csv",
        ),
        ("losses", "pressure_profile", "flow_curve", "rheology"),
        "hydraulics CASE.yaml",
        needs_mud=True,
    ),
    Kind(
        "surge",
        "Surge and swab",
        ("surge.csv", "max_trip_speed.csv"),
        ("surge", "max_trip_speed"),
        "surge CASE.yaml --speeds '60,120 ft/min'",
        needs_mud=True,
    ),
    Kind(
        "dynamics",
        "Dynamics",
        ("history.csv", "probes.csv", INDICES_TABLE),
        ("history", "orbits", "probes", "indices", "whirl", "sensor", "new_hole", "numerics"),
        "run CASE.yaml",
    ),
    Kind("modes", "Modes", ("modes.csv",), ("modes",), "modes CASE.yaml"),
)
#: pictures of every folder that are also in the section on the well
OF_THE_WELL = ("trajectory",)
_NO_ROWS = ("history.csv", "probes.csv", INDICES_TABLE)  # tables too long for a page: their ranges are shown


NOTE = "note: "  # precedes assumptions and omissions of a run, which are not warnings


@dataclass(frozen=True)
class Run:
    """A run folder in a report: its name, files and summary."""

    folder: RunFolder
    name: str
    summary: Mapping[str, Any]

    @classmethod
    def open(cls, path: Path) -> Run:
        """A run folder with its summary, empty if it has none."""
        folder = RunFolder.open(path)
        return cls(folder, path.resolve().name, folder.read_summary())

    def has(self, kind: Kind) -> bool:
        """Whether the folder holds results of a kind."""
        return any((self.folder.path / table).is_file() for table in kind.tables)

    @property
    def kinds(self) -> list[Kind]:
        """Kinds of results in the folder."""
        return [kind for kind in KINDS if self.has(kind)]


def warnings_of(run: Run) -> list[str]:
    """Sentences for the user about a run: its state, warnings and notes, and unreliable rows."""
    found: list[str] = []
    status = run.summary.get("status")
    if isinstance(status, str) and status != "done":
        found.append(f"the run is not complete: {status}")
    pivots = run.summary.get("negative_pivots")
    if isinstance(pivots, int | float) and pivots > 0 and run.summary.get("stable") is not True:
        found.append(f"the static state is not stable: {pivots:g} negative pivots")
    if not run.summary:
        found.append("no summary.json in this folder: the run did not end")
    texts = _texts(run.summary)
    found += [text for key, text in texts if key == "warnings"]
    for kind in run.kinds:
        for table in kind.tables:
            file = run.folder.path / table
            if file.is_file():
                found += _doubtful(file)
    found += [f"{NOTE}{text}" for key, text in texts if key == "notes"]
    return list(dict.fromkeys(found))


def _texts(value: Any) -> list[tuple[str, str]]:
    """(key, text) of the texts below the keys `warnings` and `notes` of a summary, wherever they are."""
    found: list[tuple[str, str]] = []
    if isinstance(value, Mapping):
        for key, part in value.items():
            if key in ("warnings", "notes") and isinstance(part, list):
                found += [(key, text) for text in part if isinstance(text, str)]
            else:
                found += _texts(part)
    elif isinstance(value, list):
        for part in value:
            found += _texts(part)
    return found


def _doubtful(file: Path) -> list[str]:
    """Rows whose status is not `ok`."""
    table = read_table(file)
    states = [str(state) for state in table.get("status [-]", ())]
    bad = sorted({state for state in states if state not in ("ok", "done", "converged")})
    return [
        f"{file.name}: {states.count(state)} of {len(states)} rows have the status '{state}'" for state in bad
    ]


def result_sections(
    runs: Sequence[Run], system: System, wanted: Sequence[str], why: Mapping[str, str]
) -> list[Section]:
    """A section for each kind of results of each run; one with the reason for each kind that no run has.

    wanted: keys of the sections; why: reason by key if results of a kind are impossible.
    """
    sections: list[Section] = []
    pictures = {run.name: _pictures(run, system) for run in runs}
    for kind in KINDS:
        if kind.key not in wanted:
            continue
        found = [run for run in runs if run.has(kind)]
        for run in found:
            title = kind.title + (f": {run.name}" if len(found) > 1 else "")
            sections.append(_section(kind, run, title, system, pictures[run.name]))
        if not found:
            missing = f"no run folder of this report holds {kind.tables[0]}"
            if kind.command:
                missing += f"; 'drillpetsc {kind.command}' writes it"
            missing = why.get(kind.key, missing)
            sections.append(Section(kind.key, kind.title, missing=missing))
    return sections


def _pictures(run: Run, system: System) -> dict[str, Any]:
    """Figures of a folder by name, without figures of the well."""
    with style.in_units(system):
        drawn = drawings(run.folder, system)
    return {name: figure for name, figure in drawn.items() if name not in OF_THE_WELL}


def _section(kind: Kind, run: Run, title: str, system: System, drawn: Mapping[str, Any]) -> Section:
    section = Section(kind.key, title)
    tables = [table for table in kind.tables if (run.folder.path / table).is_file()]
    data = ", ".join(f"{run.name}/{table}" for table in tables)
    motion = run.summary.get("motion")
    if kind.key == "statics" and isinstance(motion, str):
        section.text.append(f"Motion that friction opposes: {motion}.")
    section.grids += _figures(kind, run, system)
    others = [name for other in KINDS for name in other.pictures if other is not kind]
    first = run.kinds[0] is kind
    for name, figure in drawn.items():
        own = any(name == start or name.startswith(f"{start}_") for start in kind.pictures)
        taken = any(name == start or name.startswith(f"{start}_") for start in others)
        if own or (first and not taken):
            words = f"{kind.title}: {name.replace('_', ' ')}"
            section.pictures.append(picture(figure, words, data))
    for table in tables:
        file = run.folder.path / table
        source = f"{run.name}/{table}"
        if table in _NO_ROWS:
            section.grids += _ranges(file, system, source)
            continue
        grid = file_grid(file, system, table, source, kind.columns if table == kind.tables[0] else ())
        if grid is not None:
            section.grids.append(grid)
    if not section.grids and not section.pictures:
        section.missing = f"{data} has no rows"
    return section


def _figures(kind: Kind, run: Run, system: System) -> list[Grid]:
    """Single figures of the summary."""
    source = f"{run.name}/summary.json"
    if kind.key == "hydraulics":
        return _flows(run, system, source)
    if kind.key == "dynamics":
        final = run.summary.get("final", {})
        rows = [(label_of(title, system), *number(value, title, system)) for title, value in final.items()]
        grids = [facts(rows, "At the end of the run", source)] if rows else []
        return grids + _sensors(run, system, source) + _whirl(run, system, source)
    rows = []
    for name, value in run.summary.items():
        quantity = catalogue.find(name)
        if (
            quantity is not None
            and isinstance(value, int | float)
            and not (quantity.numerics or quantity.title.endswith(MIXED))
        ):
            rows.append((quantity.label, *number(value, quantity.title, system)))
    grids = [facts(rows, "Summary", source)] if rows and kind is run.kinds[0] else []
    more = {"roadmap": _fitted, "statics": _forces, "limits": _margins}.get(kind.key)
    return grids + (more(run, system, source) if more else [])


def _grids(
    heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str, source: str, words: Sequence[str]
) -> list[Grid]:
    """A grid, none without rows; words: heads of the columns that hold no numbers."""
    return [Grid(heads, rows, caption, source, numeric=[head not in words for head in heads])] if rows else []


def _fitted(run: Run, system: System, source: str) -> list[Grid]:
    """Parameters that calibrate fitted, with their 95 % intervals, and why others are not determined."""
    rows = []
    for name, found in run.summary.get("fit", {}).items():
        scale, _, unit = unit_of("hook_load [N]", system) if name == "block_weight" else (1.0, 0.0, "")
        words = name.replace("_", " ") if name in OTHER_FITS else f"friction, {name.replace('_', ' ')}"
        if "." in name:  # a number of the case
            (scale, unit), words = key_unit(name, str(found.get("unit", "")), system), name
        figures = (found.get("value"), *(found.get("interval") or [None, None]))
        cells = ["-" if x is None else f"{x / scale:.4g}" for x in figures]
        rows.append((words + (f" [{unit}]" if unit else ""), *cells, str(found.get("status", ""))))
    heads = ("Parameter", "Value", "95 % from", "to", "Status")
    return _grids(heads, rows, "Fitted to the measured points", source, ("Parameter", "Status"))


def _sensors(run: Run, system: System, source: str) -> list[Grid]:
    """Sensors with their resolved frequency."""
    sensors = [row for row in run.summary.get("sensors", ()) if isinstance(row, Mapping)]
    rows = []
    for row in sensors:
        depth = number(row.get("md", np.nan), "md [m]", system)[0]
        rates = [f"{row.get(key, np.nan):.4g}" for key in ("rate", "finest", "resolved_to")]
        share = f"{100 * row.get('coarse_share', np.nan):.3g}"
        clipped = str(row["clipped"]) if "clipped" in row else ""
        rows.append((str(row.get("name", "")), depth, *rates, share, str(row.get("samples", "")), clipped))
    heads = (
        "Sensor",
        f"MD [{unit_of('md [m]', system)[2]}]",
        "Rate [Hz]",
        "Filter or half the rate [Hz]",
        "Resolved by the time steps up to [Hz]",
        "Time with coarser steps [%]",
        "Samples",
        "Out of range",
    )
    return _grids(heads, rows, "Downhole sensors", source, ("Sensor",))


def _whirl(run: Run, system: System, source: str) -> list[Grid]:
    """Shares of the windows by class of whirl at the probes."""
    vibration = run.summary.get("vibration", {})
    rows = []
    for depth, classes in vibration.get("whirl", {}).items():
        place = " ".join(number(float(depth), "md [m]", system))
        rows += [(place, name, f"{100 * share:.3g}") for name, share in classes.items()]
    caption = f"Whirl in windows of three revolutions at {vibration.get('windows')} times"
    return _grids(("Probe", "Class", "Share [%]"), rows, caption, source, ("Probe", "Class"))


def _flows(run: Run, system: System, source: str) -> list[Grid]:
    """Figures of each flow rate, a column a flow rate."""
    flows = [row for row in run.summary.get("flows", ()) if isinstance(row, Mapping)]
    rows = []
    for name in flows[0] if flows else ():
        quantity = catalogue.find(name)
        values = [row.get(name) for row in flows]
        if quantity is None or not all(value is None or isinstance(value, int | float) for value in values):
            continue
        figures = np.array([np.nan if value is None else float(value) for value in values])
        unit = unit_of(quantity.title, system)[2]
        rows.append((quantity.label, *texts(in_units(quantity.title, figures, system)), unit))
    heads = ("Quantity", *("Value" for _ in flows), "Unit")
    return _grids(heads, rows, "Figures of each flow rate", source, ("Quantity", "Unit"))


#: figures of a summary of limits: path of the block, key of the figure in it, its unit
MARGINS = (
    ("weakest.safety_factor", "value", "-"),
    ("weakest.tension_ratio", "value", "-"),
    ("weakest.torque_ratio", "value", "-"),
    ("weakest.make_up_ratio", "value", "-"),
    ("weakest.fatigue_ratio", "value", "-"),
    ("weakest.side_force_per_joint", "value", "N"),
    ("neutral_point.effective", "md", "m"),
    ("neutral_point.true", "md", "m"),
    ("margin_of_overpull", "margin", "N"),
    ("max_overpull_at_bit", "pull", "N"),
    *(
        (f"max_wob.{operation}.{shape}", "wob", "N")
        for operation in ("drilling", "sliding")
        for shape in ("sinusoidal", "helical")
    ),
    *((f"available_wob.{operation}", "wob", "N") for operation in ("drilling", "sliding")),
)


def _margins(run: Run, system: System, source: str) -> list[Grid]:
    """Weakest places, margins and largest loads, each with its place."""
    summary = dict(_flat(run.summary))
    rows = []
    for path, key, unit in MARGINS:
        value = summary.get(f"{path}.{key}")
        if not isinstance(value, int | float):
            continue
        words = " ".join(path.replace("_", " ").split(".")).capitalize().replace("wob", "weight on bit")
        if path.endswith(".helical") and "helical_law" in run.summary:
            words += f": {run.summary['helical_law']}"
        md = summary.get(f"{path}.md") if key != "md" else None
        place = number(md, "md [m]", system)[0] if isinstance(md, int | float) else ""
        rows.append(
            (words, *number(value, f"{key} [{unit}]", system), place, str(summary.get(f"{path}.item", "")))
        )
    slack = summary.get("max_slackoff")
    if isinstance(slack, int | float):
        rows.append(("Max slackoff", *number(slack, "slackoff [N]", system), "", ""))
    heads = ("Quantity", "Value", "Unit", f"at MD [{unit_of('md [m]', system)[2]}]", "Item")
    return _grids(heads, rows, "Margins", source, ("Quantity", "Unit", "Item"))


def _forces(run: Run, system: System, source: str) -> list[Grid]:
    """Side forces of rigid items."""
    items = [row for row in run.summary.get("rigid_items", ()) if isinstance(row, Mapping)]
    titles = list(dict.fromkeys(title for item in items for title in item if title != "name"))
    rows = [
        (str(row.get("name", "")), *(number(row.get(title), title, system)[0] for title in titles))
        for row in items
    ]
    heads = ("Item", *(heading_of(title, system) for title in titles))
    return _grids(heads, rows, "Side forces", source, ("Item",))


def _ranges(file: Path, system: System, source: str) -> list[Grid]:
    """Least, mean and largest value of each column of a table over time."""
    table = read_table(file)
    rows = []
    for title, values in list(table.items())[1:]:
        quantity = catalogue.find(split_name(title)[0])
        finite = values[np.isfinite(values)] if values.dtype.kind == "f" else values[:0]
        if not finite.size or (quantity is not None and quantity.numerics):
            continue
        figures = in_units(title, [finite.min(), finite.mean(), finite.max()], system)
        rows.append((label_of(title, system), *texts(figures), unit_of(title, system)[2]))
    time = next(iter(table.values()))
    caption = f"Ranges over {time[0]:g} to {time[-1]:g} s, means over the rows" if rows else ""
    heads = ("Quantity", "Least", "Mean", "Largest", "Unit")
    return _grids(heads, rows, caption, source, ("Quantity", "Unit"))


def solver_section(runs: Sequence[Run]) -> Section:
    """Sizes, iterations, balances and versions of each run."""
    section = Section("solver", "Solver")
    described = {key.name: key for keys in SUMMARY_KEYS.values() for key in keys}
    left_out = ("title", "warnings", "petsc_options", "wall_by_phase", "units")
    for run in runs:
        rows = []
        for name, value in _flat(run.summary):
            key = described.get(name)
            if key is None or name.split(".")[0] in left_out or isinstance(value, list | Mapping):
                continue
            text = f"{value:.6g}" if isinstance(value, float) else str(value)
            rows.append((name, text, "" if key.unit in ("", "-") else key.unit, key.doc))
        versions = run.summary.get("versions", {})
        if isinstance(versions, Mapping):
            rows += [(f"versions.{name}", str(text), "", "") for name, text in versions.items()]
        if rows:
            heads = ("Key", "Value", "Unit (SI)", "Meaning")
            source = f"{run.name}/summary.json"
            section.grids.append(
                Grid(heads, rows, run.name, source, folded=True, numeric=(False, True, False, False))
            )
    if not section.grids:
        section.missing = "none of the runs reports its computation" if runs else "nothing was computed"
    return section


def _flat(summary: Mapping[str, Any], head: str = "") -> list[tuple[str, Any]]:
    """Keys of a summary as paths, blocks taken apart."""
    found: list[tuple[str, Any]] = []
    for key, value in summary.items():
        if isinstance(value, Mapping):
            found += _flat(value, f"{head}{key}.")
        else:
            found.append((f"{head}{key}", value))
    return found
