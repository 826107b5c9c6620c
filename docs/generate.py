"""Pages of the manual that are written from the program itself, at build time, into docs/_generated.

`write(folder)` writes
- `case/*.md`: one page a block of the case file (`case_reference`)
- `commands.md`: commands and options, from the classes of `drillpetsc.operations`
- `messages.md`: what the program answers to each file of `cases/broken`
- `warnings.md`: when each doubt about a result appears, what it means and what to do, from the functions of `drillpetsc.doubts`
- `supported.md`: which formulation takes which feature, found out by building small cases
- `notebooks/*.md`: the notebooks in docs/notebooks with the outputs that they hold, and their pictures; nothing is run
- `outputs/*.md`: the tables of columns, fields and keys that `docs/guide/outputs.md` includes, from the catalogue of outputs

Only a few names are used (`Case`, `load_case`, `cli.parser`, `operations.OPERATIONS`, `catalogue.records`), so files of the package may move.
A file whose text does not change is left alone, which keeps Sphinx from building it again.
"""

from __future__ import annotations

import argparse
import importlib.util
import inspect
import pkgutil
import re
import sys
from itertools import groupby
from pathlib import Path
from string import Formatter
from typing import Any

from case_reference import HEAD, case_class, case_pages, literals, markdown, pretty, sentence

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent


def version() -> str:
    """Version of the package."""
    import drillpetsc

    return str(drillpetsc.__version__)


def write(folder: Path) -> None:
    """Write all generated pages into a folder; files that are no longer generated are removed."""
    pages: dict[str, str | bytes] = {
        **case_pages(),
        "commands.md": commands_page(),
        "messages.md": messages_page(),
        "warnings.md": warnings_page(),
        "supported.md": supported_page(),
        **output_tables(),
        **notebook_pages(),
    }
    for name, content in pages.items():
        file, data = folder / name, content if isinstance(content, bytes) else content.encode("utf-8")
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.is_file() or file.read_bytes() != data:
            file.write_bytes(data)
    for old in (*folder.rglob("*.md"), *folder.rglob("*.png")):
        if old.relative_to(folder).as_posix() not in pages:
            old.unlink()


def notebook_pages() -> dict[str, str | bytes]:
    """Pages of the notebooks, and the pictures beside them."""
    spec = importlib.util.spec_from_file_location("notebook_runner", DOCS / "notebook_runner.py")
    assert spec is not None and spec.loader is not None
    notebook = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(notebook)
    found: dict[str, str | bytes] = {}
    for file in sorted((DOCS / "notebooks").glob("*.ipynb")):
        text, pictures = notebook.page(file.stem, notebook.read(file))
        found[f"notebooks/{file.stem}.md"] = HEAD + text
        found |= {f"notebooks/{name}": data for name, data in pictures.items()}
    return found


# ----------------------------------------------------------------------------------------------------
# commands
def commands_page() -> str:
    """Commands and options from the classes of the operations; usage lines from the parser that is made of them."""
    from drillpetsc.cli import parser
    from drillpetsc.operations import OPERATIONS
    from drillpetsc.operations.operation import Mark

    whole = parser()
    actions = next(a for a in whole._actions if isinstance(a, argparse._SubParsersAction))
    names = [operation.command() for operation in OPERATIONS]
    out = [
        f"{HEAD}(commands-options)=\n# Commands and options\n",
        "`drillpetsc COMMAND --help` shows the same. Options of PETSc have one dash ({doc}`/guide/solver-options`).\n",
        "Lists of numbers may hold ranges: `400,500 gpm`, `20..200 ft/min` for ten values in equal steps, `0:240:10 rpm` for those from "
        "0 to 240 in steps of 10. A number without a unit takes the unit of the next number that has one.\n",
        "| command | does |\n| --- | --- |",
    ]
    out += [
        f"| [`{name}`](#command-{name}) | {markdown(operation.summary())} |"
        for name, operation in zip(names, OPERATIONS, strict=True)
    ]
    out.append("")
    for name, operation in zip(names, OPERATIONS, strict=True):
        usage = " ".join(actions.choices[name].format_usage().removeprefix("usage: ").split())
        out += [
            f"(command-{name})=\n## `{name}`\n",
            markdown(sentence(operation.summary())) + "\n",
            f"```text\n{usage}\n```\n",
            "| argument | meaning |\n| --- | --- |",
        ]
        for option in operation.options():
            if Mark.PYTHON in option.marks:
                continue
            value = option.metavar or " \\| ".join(map(str, option.choices)) or option.name.upper()
            takes_value = option.kind is not bool and Mark.ARGUMENT not in option.marks
            out.append(f"| `{option.flag}`{' ' + value if takes_value else ''} | {markdown(option.text)} |")
        out.append("")
    epilog = whole.epilog or ""
    out.append(f"## Exit status and PETSc options\n\n```text\n{epilog}\n```\n")
    return "\n".join(out)


# ----------------------------------------------------------------------------------------------------
# messages
def messages_page() -> str:
    """The answer to each file of cases/broken."""
    from drillpetsc import load_case
    from drillpetsc.errors import CaseError

    folder = ROOT / "cases" / "broken"
    out = [
        f"{HEAD}(messages-table)=\n# Answers to wrong case files\n",
        "Each file of `cases/broken` has one mistake. The program answers with file, line and key, with what was given, "
        "and with what is allowed. Nothing is written, and the exit status is 2.\n",
    ]
    for file in sorted(folder.glob("*.yaml")):
        text = file.read_text(encoding="utf-8", errors="replace")
        first = text.splitlines()[0].lstrip("# ").strip() if text.strip() else "An empty file."
        if first.startswith("expect:"):
            first = ""
        try:
            load_case(file)
        except CaseError as error:
            answer = str(error).replace(f"{folder}/", "")
        else:
            continue
        out += [
            f"## {file.stem.replace('-', ' ')}\n",
            (markdown(first) + "\n") if first else "",
            f"```text\n{answer}\n```\n",
        ]
    return "\n".join(out)


# ----------------------------------------------------------------------------------------------------
# warnings
def warnings_page() -> str:
    """Every doubt about a result: its sentence, when it appears, what it means, and what to do."""
    out = [
        f"{HEAD}(warnings-table)=\n# Warnings and remarks\n",
        "A result that may be wrong is never printed without saying so. This page has every sentence that a command may add to a "
        "result, as `note:` or `WARNING:` on the screen and as `warnings` or `notes` in `summary.json`. A warning says that the result "
        "may be wrong; a remark says what it contains or leaves out. Words in italics stand for values, which are "
        "shown in the units of the case.\n",
    ]
    for module, doubts in groupby(all_doubts(), module_of):
        title = (sys.modules[module].__doc__ or "").splitlines()[0].removeprefix("Doubts about ").rstrip(".")
        out.append(f"## {title[0].upper()}{title[1:]}\n")
        together = list(doubts)
        for doubt in together:
            if doubt.weight == "remark" and not doubt.remedy:
                continue
            name = doubt.function.__name__.replace("_", " ")
            meaning = with_references(markdown(" ".join((inspect.getdoc(doubt.function) or "").split())))
            when = "; ".join(moment_text(kind) for kind in doubt.about)
            out += [
                f"### {name.capitalize()}\n",
                f"> {sentence_text(doubt.sentence)}\n",
                f"{meaning}\n",
                f"*What to do:* {doubt.remedy}\n" if doubt.remedy else "",
                f"*When:* {when}.{' A remark.' if doubt.weight == 'remark' else ''}\n",
            ]
        remarks = [q for q in together if q.weight == "remark" and not q.remedy]
        for about in dict.fromkeys(q.about for q in remarks):
            out.append(f"### Remarks: {moment_text(about[0])}\n")
            out += [f"- {sentence_text(q.sentence)}" for q in remarks if q.about == about]
            out.append("")
    return "\n".join(out)


def all_doubts() -> list[Any]:
    """Every doubt, by module: those of many commands first, then those that stand beside their commands."""
    import drillpetsc
    from drillpetsc.doubts import DOUBTS

    for found in pkgutil.walk_packages(drillpetsc.__path__, "drillpetsc."):
        if found.name.endswith(".doubts"):
            importlib.import_module(found.name)
    beside = "drillpetsc.analysis"
    return sorted(DOUBTS, key=lambda q: module_of(q) if module_of(q).startswith(beside) else "")


def module_of(doubt: Any) -> str:
    """The module in which a doubt is declared."""
    return str(doubt.function.__module__)


def moment_text(kind: type) -> str:
    """When a doubt may appear: the first sentence of a moment's docstring."""
    first = (inspect.getdoc(kind) or "").split("\n\n")[0].replace("\n", " ").split(".")[0]
    return f"{first[0].lower()}{first[1:]}"


def sentence_text(sentence: str) -> str:
    """A sentence as Markdown, with the names of its values in italics."""
    parts = []
    for text, name, _, _ in Formatter().parse(sentence):
        parts.append(markdown(text) + (f" *{name.replace('_', ' ')}* " if name else ""))
    return re.sub(r" +([,.;:)]|$)", r"\1", re.sub(r"(?<=[(=]) +| +(?= )", "", "".join(parts))).strip()


# ---------------------------------------------------------------------------------------------------- what
# goes together
PIPE = {"kind": "pipe", "length": "100 m", "od": "127 mm", "id": "108.6 mm"}
BIT = {"kind": "bit", "length": "0.5 m", "od": "215.9 mm"}
WELL = {
    "survey": {"md": ["0 m", "400 m"], "inclination": ["0 deg", "0 deg"], "azimuth": ["0 deg", "0 deg"]},
    "sections": [{"to": "end", "kind": "open_hole", "diameter": "215.9 mm"}],
}
MUD = {
    "density": "1200 kg/m3",
    "rheology": {"model": "newtonian", "viscosity": "1 mPa s"},
    "flow_rate": "10 l/s",
}
STABILIZER = {"kind": "stabilizer", "length": "1 m", "od": "0.2 m", "mass": 100}
# `+above` and `+below` are items that a feature adds to the string, `+end` its last one
DRILLS = {"well": WELL, "+end": BIT, "bottom": {"kind": "bit"}, "formation": {"drillability": 3e-8}}

FEATURES: dict[str, dict[str, Any]] = {
    "well and contact": {"well": WELL},
    "bit on bottom": {"well": WELL, "+end": BIT, "bottom": {"kind": "bit"}},
    "drilling (formation)": DRILLS,
    "bit law drag_bit": {**DRILLS, "formation": {"bit_law": "drag_bit"}},
    "bit law velocity_weakening": {
        **DRILLS,
        "formation": {
            "bit_law": {
                "kind": "velocity_weakening",
                "static": "8 kN m",
                "dynamic": "5 kN m",
                "speed": "1 rad/s",
            }
        },
    },
    "mud, mixed": {"well": WELL, "fluid": {**MUD, "formulation": "mixed"}},
    "mud, hermite": {"well": WELL, "fluid": {**MUD, "formulation": "hermite"}},
    "mud, quasi-steady": {"well": WELL, "fluid": {**MUD, "dynamics": "quasi_steady"}},
    "stabilizer above pipe": {"+above": STABILIZER},
    "stabilizer at the lower end": {"+below": STABILIZER},
    "eccentricity": {"+above": {**PIPE, "eccentricity": "2 mm"}},
    "stress-free curvature": {"+above": {**PIPE, "curvature": 1e-4}},
    "bent sub": {"+below": {**PIPE, "bend": {"angle": "1 deg"}}},
    "joints": {"joints": [{"kind": "universal", "at": "50 m"}]},
    "loads": {"loads": [{"at": "50 m", "force": [1, 0, 0]}]},
    "rotary drive (driven top)": {"top": {"kind": "driven", "stiffness": 100.0}},
    "axial force at the top": {"top": {"kind": "top_drive", "force": "10 kN"}},
    "block on a drilling line": {
        "top": {"kind": "top_drive", "hoist": {"block_mass": "25 t", "line": {"diameter": "35 mm"}}}
    },
    "held string (hydraulics)": {"well": WELL, "fluid": MUD, "hold_string": True},
    "quasi-static time": {"time": {"mode": "quasi_static", "end": "1 h"}},
}
BASE: dict[str, Any] = {"top": {"kind": "top_drive"}, "time": {"end": "1 s"}}


def assembled(*parts: dict[str, Any]) -> dict[str, Any] | None:
    """Keys of a case with all these features; None where two features are values of one key."""
    keys: dict[str, Any] = {}
    for part in parts:
        for name, value in part.items():
            if (
                isinstance(value, dict)
                and isinstance(keys.get(name), dict)
                and name in ("fluid", "formation")
            ):
                if any(key in keys[name] and keys[name][key] != value[key] for key in value):
                    return None
                keys[name] = {**keys[name], **value}
            elif name in keys and keys[name] != value:
                return None
            else:
                keys[name] = value
    items = [keys.pop(name, None) for name in ("+above", "+below", "+end")]
    keys["string"] = [item for item in (items[0], PIPE, items[1], items[2]) if item is not None]
    return {**BASE, **keys}


def refused(keys: dict[str, Any]) -> str:
    """Why a case is refused; empty when it is valid."""
    from drillpetsc.errors import CaseError

    try:
        case_class()(**keys)
    except CaseError as error:
        return f"{error.at}: {error.want}"
    return ""


def supported_page() -> str:
    """Feature by formulation, and feature by feature, tried out."""
    formulations = literals(
        case_class().model_fields["beam"].annotation.model_fields["formulation"].annotation
    )
    out = [
        f"{HEAD}(supported)=\n# Supported combinations\n",
        "The tables are found out at build time: a small case of each combination is read, and accepted or refused.\n"
        "A dash marks two values of one key, which cannot stand together.\n",
        "## Beam formulations\n\n| feature | "
        + " | ".join(f"`{f}`" for f in formulations)
        + " |\n"
        + "| --- |"
        + " --- |" * len(formulations),
    ]
    notes: list[str] = []

    def cell(*parts: dict[str, Any]) -> str:
        keys = assembled(*parts)
        if keys is None:
            return "-"
        why = refused(keys)
        if not why:
            return "yes"
        if why not in notes:
            notes.append(why)
        return f"no ({notes.index(why) + 1})"

    for name, feature in FEATURES.items():
        out.append(
            f"| {name} | "
            + " | ".join(cell(feature, {"beam": {"formulation": f}}) for f in formulations)
            + " |"
        )
    others = [
        "mud, mixed",
        "mud, hermite",
        "joints",
        "rotary drive (driven top)",
        "held string (hydraulics)",
        "quasi-static time",
        "drilling (formation)",
    ]
    out.append(
        "\n## Feature by feature\n\n| feature | "
        + " | ".join(others)
        + " |\n| --- |"
        + " --- |" * len(others)
    )
    for name, feature in FEATURES.items():
        cells = ["" if name == other else cell(feature, FEATURES[other]) for other in others]
        out.append(f"| {name} | " + " | ".join(cells) + " |")
    out.append("\n## Reasons\n")
    out += [f"{i}. {markdown(note)}" for i, note in enumerate(notes, 1)]
    out.append(
        "\nThe commands `modes` and `study --vary formulation` have limits of their own; their messages name them.\n"
    )
    return "\n".join(out)


# ----------------------------------------------------------------------------------------------------
# outputs
#: fragment -> file of the catalogue, what its entries are called
OUTPUT_TABLES = {
    "outputs/history.md": ("history.csv", "column"),
    "outputs/probes.md": ("probes.csv", "column"),
    "outputs/sensors.md": ("sensors/*.csv", "column"),
    "outputs/indices.md": ("indices.csv", "column"),
    "outputs/statics.md": ("statics.csv", "column"),
    "outputs/modes.md": ("modes.csv", "column"),
    "outputs/campbell.md": ("campbell.csv", "column"),
    "outputs/critical.md": ("critical.csv", "column"),
    "outputs/critical_map.md": ("critical_map.csv", "column"),
    "outputs/stability-map.md": ("stability_map.csv", "column"),
    "outputs/stability-boundary.md": ("stability_boundary.csv", "column"),
    "outputs/stability-runs.md": ("stability_runs.csv", "column"),
    "outputs/response.md": ("response.csv", "column"),
    "outputs/reflection.md": ("reflection.csv", "column"),
    "outputs/string.md": ("string/*.vtu", "field"),
    "outputs/trajectory.md": ("trajectory.csv", "column"),
    "outputs/hydraulics.md": ("hydraulics.csv", "column"),
    "outputs/nozzles.md": ("nozzles.csv", "column"),
    "outputs/pressure-profile.md": ("pressure_profile.csv", "column"),
    "outputs/flow-curve.md": ("flow_curve.csv", "column"),
    "outputs/dial-readings.md": ("dial_readings.csv", "column"),
    "outputs/rheology-fits.md": ("rheology_fits.csv", "column"),
    "outputs/surge.md": ("surge.csv", "column"),
    "outputs/max-trip-speed.md": ("max_trip_speed.csv", "column"),
    "outputs/roadmap.md": ("roadmap.csv", "column"),
    "outputs/sensitivities.md": ("sensitivities.csv", "column"),
    "outputs/sensitivities-history.md": ("sensitivities_history.csv", "column"),
    "outputs/uncertain.md": ("uncertain.csv", "column"),
    "outputs/uncertain-limits.md": ("uncertain_limits.csv", "column"),
    "outputs/uncertain-shares.md": ("uncertain_shares.csv", "column"),
    "outputs/limits.md": ("limits.csv", "column"),
    "outputs/contacts.md": ("contacts.csv", "column"),
    "outputs/calibration.md": ("calibration.csv", "column"),
    "outputs/calibration-series.md": ("calibration_series.csv", "column"),
    "outputs/measured.md": ("measured.csv", "column"),
    "outputs/summary-run.md": ("summary.json of run", "key"),
    "outputs/summary-statics.md": ("summary.json of statics", "key"),
    "outputs/summary-modes.md": ("summary.json of modes", "key"),
    "outputs/summary-campbell.md": ("summary.json of campbell", "key"),
    "outputs/summary-stability.md": ("summary.json of stability", "key"),
    "outputs/summary-response.md": ("summary.json of response", "key"),
    "outputs/summary-hydraulics.md": ("summary.json of hydraulics", "key"),
    "outputs/summary-surge.md": ("summary.json of surge", "key"),
    "outputs/summary-roadmap.md": ("summary.json of roadmap", "key"),
    "outputs/summary-sensitivities.md": ("summary.json of sensitivities", "key"),
    "outputs/summary-uncertain.md": ("summary.json of uncertain", "key"),
    "outputs/summary-limits.md": ("summary.json of limits", "key"),
    "outputs/summary-calibrate.md": ("summary.json of calibrate", "key"),
}


def output_tables() -> dict[str, str]:
    """A fragment with one table for each file of a run folder."""
    from drillpetsc.output.catalogue import records

    files = {file for file, _ in OUTPUT_TABLES.values()}
    missing = {record["file"] for record in records()} - files
    if missing:
        raise ValueError(f"OUTPUT_TABLES of docs/generate.py lacks {sorted(missing)}")
    return {
        page: HEAD + output_table([r for r in records() if r["file"] == file], name)
        for page, (file, name) in OUTPUT_TABLES.items()
    }


def output_table(records: list[dict[str, str]], name: str) -> str:
    """Outputs as a Markdown table; a column in which no output has a text is left out.  name: of the first column."""
    columns = {name: "name", "unit": "unit", "meaning": "doc", "sign": "sign", "present with": "condition"}
    kept = {title: entry for title, entry in columns.items() if any(r[entry] for r in records)}
    lines = ["| " + " | ".join(kept) + " |", "|" + " --- |" * len(kept)]
    for record in records:
        cells = {
            "name": f"`{record['name']}`",
            "unit": markdown(pretty(record["unit"])),
            "doc": with_references(markdown(record["doc"])),
            "sign": markdown(record["sign"]),
            "condition": markdown(record["condition"]),
        }
        lines.append("| " + " | ".join(cells[entry] for entry in kept.values()) + " |")
    return "\n".join(lines) + "\n"


def with_references(text: str) -> str:
    """`(manual: eq-LABEL)` of the program's texts as a reference to the equation, or `(manual: sec-LABEL)` to the section."""

    def reference(match: re.Match[str]) -> str:
        labels = match[1].split(", ")  # the number of an equation has parentheses of its own
        return ", ".join(
            f"{{eq}}`{label}`" if label.startswith("eq-") else f"({{ref}}`{label}`)" for label in labels
        )

    return re.sub(r"\(manual: ((?:eq|sec)-[\w-]+(?:, (?:eq|sec)-[\w-]+)*)\)", reference, text)


if __name__ == "__main__":
    write(DOCS / "_generated")
    print(*sorted(str(f.relative_to(DOCS)) for f in (DOCS / "_generated").rglob("*.md")), sep="\n")
