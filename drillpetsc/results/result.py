"""`Result`: what a command returns in Python, and what `open_run` reads from a run folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from drillpetsc.errors import CaseError
from drillpetsc.output.catalogue import tables
from drillpetsc.output.files.json_file import plain, read_summary
from drillpetsc.output.files.run_folder import (
    CALIBRATION_SERIES,
    CALIBRATION_TABLE,
    INDICES_TABLE,
    SENSITIVITIES_TABLE,
    STABILITY_RUNS_TABLE,
    STABILITY_TABLE,
    UNCERTAIN_TABLE,
    RunFolder,
)
from drillpetsc.output.files.tables import read_table
from drillpetsc.output.job import RunResult
from drillpetsc.output.sensors.files import SENSOR_TABLE, read_sensor, sensor_names
from drillpetsc.results import report as shown
from drillpetsc.results.cube import roadmap_cube, sensitivity_table, stability_map
from drillpetsc.results.datasets import Table, dataset, frame, read_string, string_dataset
from drillpetsc.unit_systems import SYSTEMS, System

#: table that determines the kind of a result -> that kind; the first one is the main table
KINDS = {
    "history.csv": "run",
    "roadmap.csv": "roadmap",
    CALIBRATION_TABLE: "calibrate",
    CALIBRATION_SERIES: "calibrate",
    "limits.csv": "limits",
    "statics.csv": "statics",
    "hydraulics.csv": "hydraulics",
    "surge.csv": "surge",
    "modes.csv": "modes",
    "campbell.csv": "campbell",
    "stability_map.csv": "stability",
    "response.csv": "response",
    "reflection.csv": "top_drive",
    SENSITIVITIES_TABLE: "sensitivities",
    UNCERTAIN_TABLE: "uncertain",
}


class Datasets(Mapping[str, Any]):
    """Datasets by name, of which each is read on first use.

    what: word for them; names: those that there are; read: a dataset from its name.
    """

    def __init__(self, what: str, names: Callable[[], list[str]], read: Callable[[str], Any]) -> None:
        self._what, self._names, self._read = what, names, read

    def __getitem__(self, name: str) -> Any:
        if name not in list(self):
            raise KeyError(f"{name}: this result has {', '.join(self) or f'no {self._what}'}")
        return self._read(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def __repr__(self) -> str:
        return f"<{self._what}: {', '.join(self) or 'none'}>"


@dataclass(repr=False)
class Result(RunResult):
    """Result of `run`, `statics`, `hydraulics`, `surge`, `roadmap`, `limits` or `modes`, with tables in SI and their units.

    folder: run folder; summary: contents of its summary.json; lines: report for the screen

    Tables are datasets of xarray whose variables have the attributes units, long_name, label, mnemonic, sign and
    description; without xarray they are arrays by name. They are read from the folder on first use, and kept. A
    result whose folder has been written again since is refused. Results can be pickled and copied; a copy has the tables that were
    read before, and reads others from the folder.
    """

    _kept: dict[str, Any] = field(default_factory=dict, compare=False)

    @property
    def kind(self) -> str:
        """run, roadmap, limits, statics, hydraulics, surge or modes; folder if the folder has no table of these."""
        found = self._files()
        return next((kind for file, kind in KINDS.items() if file in found), "folder")

    @property
    def status(self) -> str:
        """`done`, or why a run ended before its end; `unfinished` without a summary."""
        return str(self.summary.get("status", "done")) if self.summary else "unfinished"

    @property
    def tables(self) -> Datasets:
        """Datasets by the name of their file: `history`, `statics`, `hydraulics`, `flow_curve`."""
        return Datasets(
            "tables",
            lambda: [q.removesuffix(".csv") for q in self._files()],
            lambda name: self._dataset(f"{name}.csv"),
        )

    @property
    def history(self) -> Any:
        """Dataset of history.csv with the coordinate time [s]."""
        return self._dataset("history.csv")

    @property
    def probes(self) -> Any:
        """Dataset of probes.csv with the coordinate time [s]."""
        return self._dataset("probes.csv")

    @property
    def sensors(self) -> Datasets:
        """Datasets of the downhole sensors by name; what the time steps resolve is in `summary["sensors"]`."""

        def read(name: str) -> Any:
            self._check_folder()
            return dataset(read_sensor(self.folder, name), SENSOR_TABLE, self._title)

        return Datasets("sensors", lambda: sensor_names(self.folder), read)

    @property
    def indices(self) -> Any:
        """Dataset of indices.csv with the coordinate time [s], the ends of the windows."""
        return self._dataset(INDICES_TABLE)

    def find_indices(self, window: float | None = None, every: float | None = None) -> list[str]:
        """Compute the indices of drilling dynamics, as the command `vibration` does: write indices.csv and return lines for the screen.

        window: length of the windows [s], every: time between the ends of successive windows [s]; by default the case's, else 20
        and 1 s.  Raises CaseError for a result that is not a run in time.
        """
        from drillpetsc.case import load_case
        from drillpetsc.output.indices import DEFAULT_EVERY, DEFAULT_WINDOW, indices

        self._check_folder()
        file = RunFolder(self.folder).case
        if not file.is_file():
            raise CaseError(file=self.folder, got="no case.yaml", want="the folder of a run")
        case = load_case(file)
        given = (
            case.output.indices.span if case.output.indices is not None else (DEFAULT_WINDOW, DEFAULT_EVERY)
        )
        found = indices(self.folder, case, window or given[0], every or given[1])
        written = found.write(self.folder)
        self._kept.pop(INDICES_TABLE, None)
        return [
            *found.lines(self._units or "metric"),
            *(f"  note: {text}" for text in found.warnings),
            str(written),
        ]

    def waterfall(
        self, signal: str, *, order: bool = False, segment: float | None = None, units: str | None = None
    ) -> Any:
        """Amplitudes of a signal over time and frequency, as a figure of matplotlib.

        signal: SENSOR:COLUMN such as mwd:ax, history:bit_speed or probes:x_600; order: over the order of rotation
        segment: length of a segment [s], with `order` its revolutions; units: as for `plot`
        Raises CaseError for a signal that the result does not have. The numbers: `drillpetsc.vibration.spectrogram`.
        """
        from drillpetsc.plotting.run.plot import spectra

        self._check_folder()
        drawn = spectra(self.folder, (signal,), order=order, segment=segment, units=_system(units))
        return next(iter(drawn.values()))

    @property
    def statics(self) -> Any:
        """Dataset of statics.csv with the coordinate md [m], from the top down."""
        return self._dataset("statics.csv")

    @property
    def limits(self) -> Any:
        """Dataset of limits.csv with the coordinate md [m], from the top down."""
        return self._dataset("limits.csv")

    @property
    def roadmap(self) -> Any:
        """Dataset of roadmap.csv with the dimensions operation, friction and bit_depth; the friction factors are coordinates of
        friction. Rows that the roadmap does not have are nan, or an empty text."""
        return roadmap_cube(self._table("roadmap.csv"), self._title)

    @property
    def stability(self) -> Any:
        """Dataset of stability_map.csv, with what runs in time found, with the dimensions weight_on_bit [N] and rotary_speed [rpm]."""
        return stability_map(
            self._table(STABILITY_TABLE),
            self._table(STABILITY_RUNS_TABLE) if STABILITY_RUNS_TABLE in self._files() else {},
            self._title,
        )

    @property
    def sensitivities(self) -> Any:
        """Dataset of sensitivities.csv with the dimensions output and key."""
        return sensitivity_table(self._table(SENSITIVITIES_TABLE), self._title)

    @property
    def string(self) -> Any:
        """Dataset of the deformed string with the coordinates time [s] and md [m]; vectors have the dimension direction. All
        frames are read."""
        frames = self._kept.get("string")
        if frames is None:
            self._check_folder()
            frames = self._keep("string", read_string(self.folder))
        return string_dataset(frames, self._title)

    def to_frame(self, table: str | None = None, units: str | None = None) -> Any:
        """A table as a frame of pandas, with headings such as `hook_load [klbf]`; its coordinate is the index.

        table: name of the table; by default the main one of the result
        units: field, metric, metric_t or SI; by default the case's, SI if it has none
        Raises CaseError if pandas is not installed.
        """
        files = self._files()
        name = table or next((f.removesuffix(".csv") for f in (*KINDS, *files) if f in files), "")
        if f"{name}.csv" not in files:
            raise CaseError(at="table", got=name, want=f"one of {', '.join(self.tables) or 'no tables'}")
        return frame(self._table(f"{name}.csv"), f"{name}.csv", _system(units) or self._units or "SI")

    def plot(
        self,
        kind: str | None = None,
        units: str | None = None,
        backend: Literal["matplotlib", "plotly"] = "matplotlib",
    ) -> Any:
        """A picture of the result, as a figure of matplotlib or of plotly; the pictures are the same as from the command `plot`.

        kind: name of the picture, such as history, orbits, along_depth, flow_curve, surge; by default the first one
        units: field, metric, metric_t or SI; by default the case's
        backend: matplotlib, or plotly to zoom (needs the package; pictures of lines and bars)
        """
        from drillpetsc.plotting.run.plot import figures, picture_names

        if backend not in ("matplotlib", "plotly"):
            raise CaseError(at="backend", got=backend, want="matplotlib or plotly")
        self._check_folder()
        system = _system(units)
        drawn = figures(self.folder, system, None if kind is None else (kind,), first=kind is None)
        if not drawn:
            names = ", ".join(picture_names(self.folder))
            raise CaseError(
                at="kind", got=kind, want=f"one of {names}" if names else "a result with a table to draw"
            )
        picture = next(iter(drawn.values()))
        if backend == "matplotlib":
            return picture
        from drillpetsc.plotting.interactive import plotly_figure

        return plotly_figure(picture)

    def report(
        self,
        path: str | Path | None = None,
        *,
        units: str | None = None,
        sections: Sequence[str] = (),
        interactive: bool = False,
    ) -> Path:
        """Write the HTML report of the command `report` on this result; returns its path.

        path: file whose name ends with .html; by default report.html in the run folder. An older report is replaced
        units: field, metric, metric_t or SI; by default the result's
        sections: some of its sections, such as well, string, mud, inputs; by default all
        interactive: its pictures of lines and bars zoom in a browser (needs plotly)
        """
        from drillpetsc.reporting import report as written

        self._check_folder()
        return written(
            self.folder,
            out=path,
            units=_system(units) or self._units,
            sections=tuple(sections),
            interactive=interactive,
        )

    def export(
        self,
        path: str | Path | None = None,
        *,
        units: str | None = None,
        format: Literal["csv", "xlsx", "las"] = "csv",
        columns: Sequence[str] = (),
    ) -> list[Path]:
        """Write the tables for other programs, as the command `export` does; returns the files.

        path: folder of the files; by default `export` in the run folder
        units: field, metric, metric_t or SI; by default the result's, else metric
        format: csv, xlsx, las or parquet
        columns: names of columns; by default all
        """
        from drillpetsc.reporting.export import export

        self._check_folder()
        system = _system(units) or self._units
        return export(self.folder, path, units=system, format=format, columns=tuple(columns))[0]

    # ------------------------------------------------------------------ shown
    @property
    def _title(self) -> str:
        return str(self.summary.get("title") or self.folder.name)

    @property
    def _units(self) -> System | None:
        """Units of the command or of the case."""
        from drillpetsc.plotting.style import units_of_run

        units = self.summary.get("units")
        return units if units in SYSTEMS else units_of_run(RunFolder(self.folder).case)

    def _report(self) -> tuple[str, shown.Rows, list[str], str]:
        kind, main = self.kind, {}
        if kind in ("surge", "modes", "roadmap", "limits"):
            main = {f"{kind}.csv": self._table(f"{kind}.csv")}
        figures = shown.main_figures(kind, self.summary, main, self._units or "metric")
        warnings = shown.warnings_of(self.summary)
        if not self.summary:
            warnings.append("there is no summary.json: the computation has not ended")
        return f"{self._title}: {kind}", figures, warnings, str(self.folder)

    def __str__(self) -> str:
        return shown.text_report(*self._report())

    def __repr__(self) -> str:
        return f"<Result of {self.kind}: {self._title}, {self.folder}>"

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """The report of the result, for IPython."""
        printer.text(repr(self) if cycle else str(self))

    def _repr_html_(self) -> str:
        """The report of the result with a picture, for a notebook."""
        from drillpetsc.plotting.run.plot import figures

        parts = self._report()
        self._check_folder()
        drawn = figures(self.folder, None, first=True)
        return shown.html_report(*parts, next(iter(drawn.values()), None))

    # ------------------------------------------------------------------ files
    def _files(self) -> list[str]:
        return [file for file in tables() if file in self._kept or (self.folder / file).is_file()]

    def _table(self, file: str) -> Table:
        if file in self._kept:
            return self._kept[file]
        if file not in self._files():
            has = ", ".join(name.removesuffix(".csv") for name in self._files())
            raise CaseError(
                file=self.folder,
                got=f"no {file}",
                want=f"a result with it; this one has: {has or 'no tables'}",
            )
        self._check_folder()
        return self._keep(file, read_table(self.folder / file))

    def _dataset(self, file: str) -> Any:
        return dataset(self._table(file), file, self._title)

    def _keep(self, name: str, value: Any) -> Any:
        """Keep the data read, unless the computation still writes."""
        if self.summary:
            self._kept[name] = value
        return value

    def _check_folder(self) -> None:
        """Raise CaseError if the folder is gone, or holds the results of another computation by now."""
        if not self.folder.is_dir():
            raise CaseError(file=self.folder, got="no such folder", want="the run folder of the result")
        file = RunFolder(self.folder).summary
        if self.summary and file.is_file():
            mine = {key: value for key, value in self.summary.items() if key != "nothing_left"}
            if plain(mine) != read_summary(file):
                raise CaseError(
                    file=self.folder,
                    got="results of another computation",
                    want="the results of this object",
                    hint="drillpetsc.open_run reads the present contents of the folder",
                )


def _system(units: str | None) -> System | None:
    """The system of units of this name; CaseError for other words."""
    if units is None:
        return None
    for system in SYSTEMS:
        if units == system:
            return system
    raise CaseError(at="units", got=units, want=", ".join(SYSTEMS))


def result_of(computed: RunResult) -> Result:
    """The result of a command, with tables and pictures."""
    return Result(computed.folder, computed.summary, computed.lines)


def open_run(folder: str | Path) -> Result:
    """The result in a run folder; nothing is computed, and PETSc and MPI are not started.

    folder: run folder of `run`, `statics`, `hydraulics`, `surge` or `modes`, finished or not
    Raises CaseError if the folder does not exist or holds no results.
    """
    path = Path(folder)
    if not path.is_dir():
        raise CaseError(at="folder", got=folder, want="a run folder that exists")
    result = Result(path, RunFolder(path).read_summary())
    if not result.summary and not result._files():
        raise CaseError(at="folder", got=folder, want="a run folder with tables or a summary.json")
    return result
