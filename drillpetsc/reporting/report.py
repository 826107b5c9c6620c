"""`drillpetsc report`: one HTML file on a case and its run folders.

The file is self-contained: style, pictures and tables are in it, and there is no script unless its pictures zoom. The
same input gives the
same bytes; the date is the date of the newest result, or SOURCE_DATE_EPOCH (reproducible-builds.org).
"""

from __future__ import annotations

import datetime
import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case import Case, load_case
from drillpetsc.case.plausible.plausibility import notes
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.output import catalogue
from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.files.run_folder import SWEEP_TABLE, WELLS_TABLE
from drillpetsc.output.files.tables import read_titles, split_name
from drillpetsc.output.shown_units import lengths_shown
from drillpetsc.plotting import style
from drillpetsc.reporting.answer import answer
from drillpetsc.reporting.inputs import mud_section, rig_rows, string_section, well_section
from drillpetsc.reporting.page import MIXED, Grid, Section, pictures_that_zoom
from drillpetsc.reporting.results import KINDS, NOTE, Run, result_sections, solver_section, warnings_of
from drillpetsc.reporting.units import unit_of
from drillpetsc.unit_systems import System, display_unit
from drillpetsc.version import __version__

SECTIONS = ("well", "string", "mud", *(kind.key for kind in KINDS), "inputs", "solver")
_NOT_COMPARED = ("output", "petsc", "time", "title")  # blocks in which runs of one case may differ
DATUM = "rig floor, 0 m MD"

#: conventions of all reports: signs of field reports (manual: sec-guide-report)
AGREED = (
    "Measured and true vertical depths are positive down from the datum.",
    "Tension is positive, compression negative. The effective tension is what buckles; the axial force is the wall's.",
    "The hook load is the pull of the string at the rig; the total hook load contains the block. Both are positive up.",
    "Torques are positive when the string is turned clockwise, seen from above, against a resistance.",
    "The weight on bit is positive on the rock. The side force is the push of the wall on the string.",
    "Pressures are gauge pressures. ECD is the annulus pressure over gravity and the vertical depth below the flow line.",
    "Tool faces and clock directions: 0 is the high side (north below 5 degrees), clockwise looking down.",
    "Trip speeds are positive; the operation names the direction.",
)


@dataclass(frozen=True)
class Source:
    """The sources of a report.

    case; file: of the case, given or in the first run folder; runs.
    """

    case: Case
    file: Path
    given: bool
    runs: tuple[Run, ...]


def report(
    *paths: str | os.PathLike,
    out: str | os.PathLike | None = None,
    units: System | None = None,
    sections: Sequence[str] = (),
    interactive: bool = False,
) -> Path:
    """Write a report on run folders, on a case, or on a case and its run folders; returns its path.

    paths: run folders, and at most one case file
    out: file to be written; by default report.html in the first run folder, or <case>-report.html
    units: field, metric, metric_t or SI; by default the case's, else metric
    sections: names of SECTIONS; by default all
    interactive: pictures of lines and bars zoom, by the script of plotly, which is in the file once (4.5 MB)
    """
    unknown = [name for name in sections if name not in SECTIONS]
    if unknown:
        raise CaseError(at="--sections", got=unknown[0], want=", ".join(SECTIONS))
    source = _source([Path(path) for path in paths])
    if out is not None and Path(out).suffix.lower() not in (".html", ".htm"):
        raise CaseError(at="--out", got=out, want="a file whose name ends with .html")
    if out is not None:
        target = Path(out)
    else:
        target = source.runs[0].folder.report if source.runs else Path(f"{source.file.stem}-report.html")
    system = units or source.case.shown_units
    text = html(source, system, tuple(sections) or SECTIONS, interactive)
    try:
        return replace_text(target, text)
    except OSError as error:
        raise CaseError(
            at="--out", got=target, want=f"a file that can be written ({error.strerror})"
        ) from None


def _source(paths: Sequence[Path]) -> Source:
    """The case and the runs of the arguments, in their order."""
    cases = [path for path in paths if not path.is_dir()]
    for path in cases:
        if path.suffix.lower() not in (".yaml", ".yml"):
            raise CaseError(at="RUN", got=path, want="a run folder that exists, or a case file")
    if len(cases) > 1:
        raise CaseError(at="CASE", got=cases[1], want="one case file in a report")
    runs = []
    for path in dict.fromkeys(path for path in paths if path.is_dir()):
        if (path / SWEEP_TABLE).is_file() or (path / WELLS_TABLE).is_file():
            raise CaseError(
                at="RUN", got=path, want="a single run; this is a sweep: give folders of its members"
            )
        run = Run.open(path)
        if not run.kinds:
            raise CaseError(at="RUN", got=path, want="a run folder that holds results")
        runs.append(run)
    if cases:
        return Source(load_case(cases[0]), cases[0], True, tuple(runs))
    if not runs:
        raise CaseError(at="RUN", want="a run folder or a case file")
    file = runs[0].folder.case
    if not file.is_file():
        raise CaseError(
            at="RUN", got=runs[0].folder.path, want="a run folder with case.yaml; or also give the case file"
        )
    return Source(load_case(file), file, False, tuple(runs))


def html(source: Source, system: System, wanted: Sequence[str], interactive: bool = False) -> str:
    """The page as text; ``interactive``: its pictures zoom."""
    import jinja2

    environment = jinja2.Environment(
        autoescape=True,
        loader=jinja2.FileSystemLoader(Path(__file__).parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    case = source.case
    title = case.title or source.file.stem
    with style.in_units(system), style.look(), pictures_that_zoom(interactive):
        parts = _sections(source, system, wanted, title)
    return environment.get_template("template.html").render(
        title=title,
        version=__version__,
        head=_head(source, system),
        answer=answer(source.runs, case, system),
        warnings=_said(source, system, False),
        notes=_said(source, system, True),
        agreed=AGREED,
        signs=_signs(source.runs, system),
        sections=parts,
        script=_script(parts) if interactive else "",
    )


def _script(sections: Sequence[Section]) -> str:
    """The script of plotly, empty if no picture zooms."""
    from drillpetsc.plotting.interactive import plotly_script

    return plotly_script() if any(p.plot for section in sections for p in section.pictures) else ""


def _sections(source: Source, system: System, wanted: Sequence[str], title: str) -> list[Section]:
    case, runs = source.case, source.runs
    parts: list[Section] = []
    if "well" in wanted:
        parts.append(well_section(case, system, title))
    if "string" in wanted:
        parts.append(string_section(case, system, title))
    if "mud" in wanted:
        parts.append(mud_section(case, system))
    why = {kind.key: "no mud in this case" for kind in KINDS if kind.needs_mud and case.fluid is None}
    parts += result_sections(runs, system, wanted, why)
    if "inputs" in wanted:
        parts.append(_inputs(source))
    if "solver" in wanted:
        parts.append(solver_section(runs))
    return parts


def _head(source: Source, system: System) -> list[tuple[str, str]]:
    """Facts on the report itself."""
    case = source.case
    rig = case.rig
    rows = [
        ("Case file", source.file.name + ("" if source.given else f" of {source.runs[0].name}")),
        ("SHA-256 of it", hashlib.sha256(source.file.read_bytes()).hexdigest()),
        ("Results", ", ".join(run.name for run in source.runs) or "none: the case alone"),
        ("Date", _date(source)),
        ("Program", f"drillpetsc {__version__}"),
        ("Depths from", (rig.datum if rig is not None else "") or DATUM),
        ("Units", {"metric_t": "metric, forces in tonnes"}.get(system, system)),
    ]
    return rows + [(name, f"{value} {unit}") for name, value, unit in rig_rows(case, system)]


def _date(source: Source) -> str:
    """Day of the report in UTC."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if given:
        try:
            seconds = int(given)
            return datetime.datetime.fromtimestamp(seconds, datetime.UTC).date().isoformat()
        except (ValueError, OverflowError, OSError):
            raise CaseError(at="SOURCE_DATE_EPOCH", got=given, want="whole seconds since 1970") from None
    tables = [run.folder.path / table for run in source.runs for kind in run.kinds for table in kind.tables]
    files = [file for file in tables if file.is_file()] or [source.file]
    newest = max(file.stat().st_mtime for file in files)
    day = datetime.datetime.fromtimestamp(newest, datetime.UTC).date().isoformat()
    return f"{day} ({'newest result' if source.runs else 'case file'})"


def _said(source: Source, system: System, notes_only: bool) -> list[tuple[str, list[str]]]:
    """(where, texts) of the warnings, or of the notes: assumptions and omissions of the results."""
    found = []
    for where, texts in _warnings(source):
        chosen = [text for text in texts if text.startswith(NOTE) is notes_only]
        if chosen:
            found.append((where, [lengths_shown(text.removeprefix(NOTE), system) for text in chosen]))
    return found


def _warnings(source: Source) -> list[tuple[str, list[str]]]:
    """(where, texts) of all warnings: differences of cases first, then the case, then each run."""
    found: list[tuple[str, list[str]]] = []
    own = _compared(source.case)
    for run in source.runs:
        texts = []
        if run.folder.case.is_file() and run.folder.case != source.file:
            other = _compared(load_case(run.folder.case))
            keys = [key for key in sorted({*own, *other}) if own.get(key) != other.get(key)]
            if keys:
                texts.append(
                    f"this run is of another case than {source.file.name}: {', '.join(keys)} differ. Well, string and mud "
                    f"of this report come from {source.file.name}"
                )
        elif not run.folder.case.is_file():
            texts.append("no case.yaml in this folder: whether it is of this case was not checked")
        texts += warnings_of(run)
        if texts:
            found.append((run.name, texts))
    case = [line.removeprefix("WARNING: ") for line in notes(source.case) if line.startswith("WARNING")]
    return ([(source.file.name, case)] if case else []) + found


def _compared(case: Case) -> dict[str, Any]:
    return {key: value for key, value in case_data(case).items() if key not in _NOT_COMPARED}


def _signs(runs: Sequence[Run], system: System) -> Grid:
    """Quantities of the results: mnemonic, unit in this report, meaning of a positive value."""
    titles: dict[str, None] = {}
    for run in runs:
        for kind in run.kinds:
            for table in kind.tables:
                file = run.folder.path / table
                if file.is_file():
                    titles |= dict.fromkeys(read_titles(file))
    rows: dict[str, tuple[str, str, str, str]] = {}
    for title in titles:
        quantity = catalogue.find(split_name(title)[0])
        if quantity is not None and not quantity.numerics and quantity.name not in rows:
            unit = unit_of(title, system)[2]
            if title.endswith(MIXED):
                unit = " or ".join(display_unit(kind, system)[2] for kind in ("force", "torque"))
            label = quantity.label.replace("NNN m", "its depth")
            rows[quantity.name] = label, quantity.mnemonic, unit, quantity.sign
    heads = ("Quantity", "Mnemonic", "Unit", "Positive")
    return Grid(heads, list(rows.values()), "Quantities of this report", folded=True)


def _inputs(source: Source) -> Section:
    """The case in SI with every default, and the sources of figures that it did not give."""
    section = Section("inputs", "Resolved inputs")
    resolved = [run.folder.resolved_case for run in source.runs if run.folder.resolved_case.is_file()]
    if source.given:
        text, where = source.case.to_sourced_yaml(), f"{source.file.name}, resolved"
    elif resolved:
        text = resolved[0].read_text(encoding="utf-8")
        where = f"{resolved[0].parent.resolve().name}/{resolved[0].name}"
    else:
        text, where = source.file.read_text(encoding="utf-8"), f"{source.runs[0].name}/case.yaml"
    figures = _figures(source.case, text)
    if figures:
        section.grids.append(
            Grid(
                ("Item", "Key", "Value (SI)", "From"),
                figures,
                "Figures that the case did not give",
                where,
                True,
            )
        )
    section.verbatim.append((f"{where}: every key in SI", text))
    if source.given:
        section.verbatim.append(
            (f"{source.file.name} as written", source.file.read_text(encoding="utf-8-sig"))
        )
    return section


def _figures(case: Case, text: str) -> list[tuple[str, str, str, str]]:
    """Rows (item, key, value, source) of figures from catalogue, defaults and formulas.

    text: the resolved case, whose comments name the sources that the case no longer names
    """
    if case.figures.of_item:
        rows = []
        for number, found in case.figures.of_item.items():
            for figure in found:
                value = f"{figure.value:.6g}" if isinstance(figure.value, float) else str(figure.value)
                name = f"{number}: {case.string[number].name}"
                rows.append((name, figure.key, f"{value} {figure.unit}".strip(), figure.source))
        return rows
    rows = []
    item = ""
    for line in text.splitlines():
        content, mark, origin = line.partition("# from: ")
        key, _, value = content.strip().removeprefix("- ").partition(":")
        if key == "name":
            item = value.strip()
        if mark:
            rows.append((item, key, value.strip(), origin.strip()))
    return rows
