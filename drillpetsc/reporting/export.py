"""`drillpetsc export`: tables of a run folder for other programs, with units and headers as engineers write them.

- csv: a file for each table, with headings such as `Hook load [klbf]`
- xlsx: one workbook, a sheet for each table
- parquet: a file for each table, with the same headings; name and unit of each column are in its metadata
- las: a LAS 2.0 file for each table over time or depth, with mnemonics such as HKLD (Canadian Well Logging Society, LAS 2.0, 1992)
"""

from __future__ import annotations

import io
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError
from drillpetsc.output import catalogue
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.files.run_folder import SWEEP_TABLE, WELLS_TABLE, RunFolder
from drillpetsc.output.files.tables import csv_text, read_table, split_name
from drillpetsc.output.sensors.files import read_sensor, sensor_names
from drillpetsc.plotting.style import units_of_run
from drillpetsc.reporting.units import in_units, label_of, unit_of
from drillpetsc.unit_systems import SYSTEMS, System

Format = Literal["csv", "xlsx", "las", "parquet"]
FORMATS: tuple[Format, ...] = get_args(Format)
INDICES = (
    "time", "md", "bit_depth", "pump_flow", "mode", "operation", "pipe", "ff_cased", "ff_open_hole", "ff_groups",
    "trip_speed", "rotary_speed", "place", "output", "key", "method", "quantile",
)  # columns that say what a row is of: every exported table keeps them  # fmt: skip
LAS_INDICES = {"time": "TIME", "md": "DEPT"}
NULL = -999.25  # usual mark of a missing value in LAS files
MOST_ROWS = 1_048_575  # of a sheet of xlsx below its headings
DIGITS = 10
INSTALL = "pip install 'drillpetsc[files]'"
INSTALL_PARQUET = "pip install 'drillpetsc[parquet]'"

Table = dict[str, np.ndarray]


def export(
    run: str | os.PathLike,
    out: str | os.PathLike | None = None,
    *,
    units: System | None = None,
    format: Format = "csv",
    columns: Sequence[str] = (),
) -> tuple[list[Path], list[str]]:
    """Write the tables of a run folder for other programs; returns the files, and remarks on omissions.

    run: run folder
    out: folder of the files; by default `export` in the run folder. Older files of the same names are replaced
    units: field, metric, metric_t or SI; by default the case's, else metric
    format: csv, xlsx, las or parquet
    columns: names of columns, such as hook_load; by default all. Columns that say what a row is of, such as time, depth and operation, are always included
    Raises CaseError for a folder without tables, for columns that no table has, and if a package is missing.
    """
    for value, allowed, at in ((format, FORMATS, "--format"), (units, (None, *SYSTEMS), "--units")):
        if value not in allowed:
            raise CaseError(at=at, got=value, want=", ".join(word for word in allowed if word))
    folder = RunFolder(Path(run))
    if not folder.path.is_dir():
        raise CaseError(at="RUN", got=run, want="a run folder that exists")
    system: System = units or units_of_run(folder.case) or "metric"
    tables, remarks = _chosen(_tables(folder.path), columns), list[str]()
    into = Path(out) if out is not None else folder.path / "export"
    summary = folder.read_summary()
    title = str(summary.get("title") or folder.path.resolve().name)
    contents: dict[str, bytes] = {}
    if format == "xlsx":
        contents[f"{folder.path.resolve().name}.xlsx"] = _workbook(tables, system)
    for name, table in tables.items():
        if format == "csv":
            contents[f"{name}.csv"] = _csv(table, system)
        elif format == "parquet":
            contents[f"{name}.parquet"] = _parquet(table, system)
        elif format == "las":
            text = _las(table, system, f"{title}: {name}", remarks, name)
            if text:
                contents[f"{name}.las"] = text.encode()
    if not contents:
        raise CaseError(at="RUN", got=run, want="a table over time or depth for LAS", hint="; ".join(remarks))
    try:
        into.mkdir(parents=True, exist_ok=True)
        files = [_written(into / name, data) for name, data in contents.items()]
    except OSError as error:
        raise CaseError(
            at="--out", got=into, want=f"a folder that can be written ({error.strerror})"
        ) from None
    return files, remarks


def _written(file: Path, data: bytes) -> Path:
    return replace_file(file, lambda temporary: temporary.write_bytes(data))


def _tables(folder: Path) -> dict[str, Table]:
    """Tables of a folder by name, without empty tables."""
    if (folder / SWEEP_TABLE).is_file() or (folder / WELLS_TABLE).is_file():
        raise CaseError(at="RUN", got=folder, want="a single run; this is a sweep: give a member's folder")
    found = {}
    for file in sorted(folder.glob("*.csv")):
        if file.name not in catalogue.outputs_by_file():
            continue  # another's
        try:
            table = read_table(file)
        except ValueError as error:
            raise CaseError(at="RUN", got=file, want=f"a table of this program ({error})") from None
        if len(next(iter(table.values()), ())):
            found[file.stem] = table
    found |= {f"sensor_{name}": read_sensor(folder, name) for name in sensor_names(folder)}
    if not found:
        raise CaseError(at="RUN", got=folder, want="a run folder that holds tables with rows")
    return found


def _chosen(tables: dict[str, Table], columns: Sequence[str]) -> dict[str, Table]:
    """The tables that have one of the columns, with these columns and those that say what a row is of."""
    if not columns:
        return tables
    names = {split_name(title)[0] for table in tables.values() for title in table}
    for column in columns:
        if column not in names:
            raise CaseError(
                at="--columns",
                got=column,
                want=f"names of columns: {', '.join(sorted(names))}",
                hint=suggestion(column, names),
            )
    found = {}
    for name, table in tables.items():
        if any(split_name(title)[0] in columns for title in table):
            found[name] = {
                title: values
                for title, values in table.items()
                if split_name(title)[0] in (*columns, *INDICES)
            }
    return found


def _shown(table: Table, system: System) -> list[tuple[str, np.ndarray]]:
    """(heading, values in its unit) of each column; equal headings also get the name of the column."""
    found: list[tuple[str, np.ndarray]] = []
    words = [_heading(title, values, system) for title, values in table.items()]
    for heading, (title, values) in zip(words, table.items(), strict=True):
        name = split_name(title)[0]
        numeric = values.dtype.kind in "fiu"
        text = f"{name}: {heading}" if words.count(heading) > 1 else heading
        found.append((text, in_units(title, values, system) if numeric else values))
    return found


def _heading(title: str, values: np.ndarray, system: System) -> str:
    unit = unit_of(title, system)[2] if values.dtype.kind in "fiu" else ""
    return f"{_label(title, system)} [{unit}]" if unit else _label(title, system)


def _label(title: str, system: System) -> str:
    """Words for a column; for a probe or joint they name its depth."""
    name = split_name(title)[0]
    return label_of(title, system).replace("NNN", name.rpartition("_")[2])


def _csv(table: Table, system: System) -> bytes:
    columns = _shown(table, system)
    rows = ([_text(value) for value in row] for row in zip(*[v.tolist() for _, v in columns], strict=True))
    return csv_text([heading for heading, _ in columns], rows).encode()


def _text(value: Any) -> str:
    """A cell: empty if it holds no number."""
    if not isinstance(value, int | float):
        return str(value)
    return f"{value:.{DIGITS}g}" if math.isfinite(value) else ""


def _workbook(tables: dict[str, Table], system: System) -> bytes:
    try:
        from openpyxl import Workbook
        from openpyxl.cell import WriteOnlyCell
    except ImportError:
        raise CaseError(
            at="--format", got="xlsx", want="csv, unless the package openpyxl is installed", hint=INSTALL
        ) from None
    book = Workbook(write_only=True)
    for name, table in tables.items():
        columns = _shown(table, system)
        if len(columns[0][1]) > MOST_ROWS:
            raise CaseError(at="--format", got=f"{name} with {len(columns[0][1])} rows", want="csv for it")
        sheet = book.create_sheet(name[:31])
        sheet.freeze_panes = "A2"
        for row in ([h for h, _ in columns], *zip(*[v.tolist() for _, v in columns], strict=True)):
            cells = []
            for value in row:
                number = isinstance(value, int | float)
                cell = WriteOnlyCell(sheet, value if number and math.isfinite(value) else None)
                if not number:
                    cell.value = re.sub(r"[\x00-\x08\x0b\x0c\x0e-\x1f]", "", str(value))
                    cell.data_type = "s"  # a text that begins with = is not a formula
                cells.append(cell)
            sheet.append(cells)
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


def _parquet(table: Table, system: System) -> bytes:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        missing = isinstance(error, ModuleNotFoundError)
        raise CaseError(
            at="--format",
            got="parquet",
            want="csv, unless the package pyarrow is installed",
            hint=INSTALL_PARQUET if missing else str(error),
        ) from None
    columns, fields = [], []
    for (heading, values), title in zip(_shown(table, system), table, strict=True):
        cells = pyarrow.array(values if values.dtype.kind in "fiu" else [str(v) for v in values.tolist()])
        unit = unit_of(title, system)[2] if values.dtype.kind in "fiu" else ""
        columns.append(cells)
        about = {"name": split_name(title)[0], "unit": unit}
        fields.append(pyarrow.field(heading, cells.type, metadata=about))
    file = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_arrays(columns, schema=pyarrow.schema(fields)), file)
    return file.getvalue()


def _las(table: Table, system: System, title: str, remarks: list[str], name: str) -> str:
    """A table as LAS 2.0; an empty text, with a remark, if it has no index that rises or falls."""
    first = next(iter(table))
    kind = split_name(first)[0]
    steps = np.diff(table[first]) if table[first].dtype.kind in "fiu" else np.array([0.0])
    if kind not in LAS_INDICES or not (np.all(steps > 0) or np.all(steps < 0)):
        keep = np.concatenate([[True], steps != 0.0])
        again = kind in LAS_INDICES and len(steps) > 0 and np.all(steps >= 0)
        if not again:
            remarks.append(f"{name} is left out: its rows have no time or depth that rises")
            return ""
        remarks.append(f"{name}: of rows at one {kind} the first is kept")
        table = {heading: values[keep] for heading, values in table.items()}
    curves: list[tuple[str, str, str, np.ndarray]] = []
    used: set[str] = set()
    for heading, values in table.items():
        if values.dtype.kind not in "fiu":
            remarks.append(f"{name}: {split_name(heading)[0]} is left out: LAS holds numbers")
            continue
        unit = unit_of(heading, system)[2].replace(" ", ".")
        mnemonic = LAS_INDICES[kind] if not curves else _mnemonic(heading, used)
        used.add(mnemonic)
        curves.append((mnemonic, unit, _label(heading, system), in_units(heading, values, system)))
    index = curves[0][3]
    even = np.diff(index)
    step = float(even[0]) if len(even) and np.allclose(even, even[0], rtol=1e-9) else 0.0
    unit = curves[0][1]
    lines = [
        "~Version",
        "VERS.   2.0 : CWLS log ASCII standard, version 2.0",
        "WRAP.   NO  : one line per step",
        "~Well",
        f"STRT.{unit} {index[0]:.{DIGITS}g} : first",
        f"STOP.{unit} {index[-1]:.{DIGITS}g} : last",
        f"STEP.{unit} {step:.{DIGITS}g} : step, 0 if it varies",
        f"NULL.   {NULL} : no value",
        f"WELL.   {_one_line(title)} : title",
        "~Curve",
        *(f"{mnemonic}.{unit} : {_one_line(words)}" for mnemonic, unit, words, _ in curves),
        "~ASCII",
    ]
    data = np.column_stack([values for *_, values in curves])
    rows = (" ".join(f"{v:.{DIGITS}g}" if math.isfinite(v) else str(NULL) for v in row) for row in data)
    return "\n".join([*lines, *rows]) + "\n"


def _mnemonic(heading: str, used: set[str]) -> str:
    """The mnemonic of a column, with a depth or a number if another column has it."""
    name = split_name(heading)[0]
    quantity = catalogue.find(name)
    word = quantity.mnemonic if quantity is not None and quantity.mnemonic else name.upper()
    word = re.sub(r"[^A-Z0-9_]", "_", word.replace("NNN", name.rpartition("_")[2]).upper())
    tail = name.rpartition("_")[2]
    if word in used and re.fullmatch(r"[\d.]+", tail):
        word += "_" + tail.replace(".", "_")
    number, found = 2, word
    while found in used:
        found, number = f"{word}_{number}", number + 1
    return found


def _one_line(text: str) -> str:
    """A text for a line of a LAS header, in which a colon begins the description."""
    return " ".join(text.replace(":", ",").split())
