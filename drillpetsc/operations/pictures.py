"""Commands that show results: view, paraview, plot, serve, vibration, report, export."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any, Literal

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import Names, holds, in_unit, names, reading
from drillpetsc.operations.operation import Mark, Operation, Units
from drillpetsc.parallel import initialise_petsc, world_rank

RunFolder = Annotated[str, Mark.ARGUMENT, "RUN", "the run folder"]
Signals = Annotated[tuple[str, ...], "SIGNAL"]
TIME = in_unit("s", "a time above 0, such as '20 s'")


class View(Operation):
    """Picture or animation of the string in its hole."""

    folder: RunFolder
    field: Annotated[str | None, "field that colours the string (default: the effective tension)"] = None
    time: Annotated[float | None, "simulated time of the picture [s] (default: the last frame)"] = None
    animate: Annotated[bool, "all frames, as an animation"] = False
    lateral_scale: Annotated[
        float | None, "exaggeration of lateral offsets (default: automatic, and stated in the picture)"
    ] = None
    interval: Annotated[
        tuple[str, str] | None, "FROM TO", "measured depths to look at, in m, or with a unit: '4000 ft'"
    ] = None
    out: Annotated[str | None, "FILE", "file to be written"] = None
    units: Units = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.plotting.run.view import view

        say_unfinished(self.folder)
        interval = None
        if self.interval:
            start, end = (depth(text) for text in self.interval)
            interval = start, end
        with reading(self.folder):
            file = view(
                self.folder,
                self.out,
                field=self.field,
                time=self.time,
                animate=self.animate,
                lateral_scale=self.lateral_scale,
                interval=interval,
                say=print,
                units=self.units,
            )
        return [file]


class Paraview(Operation):
    """Scene of a run for ParaView: the curved string as a tube, its hole, contact forces, mud."""

    folder: RunFolder
    out: Annotated[str | None, "DIR", "folder of the files (default: paraview in the run folder)"] = None
    field: Annotated[str | None, "field that colours the string (default: the effective tension)"] = None
    pieces: Annotated[
        int, holds(lambda count: 1 <= count <= 64, "1 to 64"), "N", "straight lines along an element"
    ] = 4
    lateral_scale: Annotated[
        float | None, "exaggeration of lengths across the hole (default: automatic; 1: true to scale)"
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.plotting.run.paraview import export_scene

        say_unfinished(self.folder)
        with reading(self.folder):
            scene = export_scene(
                self.folder,
                self.out,
                field=self.field,
                pieces=self.pieces,
                lateral_scale=self.lateral_scale,
            )
        return [
            f"{scene.script}  (frames: {scene.frames}, lengths across the hole {scene.lateral_scale:g} times larger than along it)",
            f"  open it: paraview --script={scene.script}",
        ]


class Plot(Operation):
    """Time histories, probe orbits, forces along depth, as pictures."""

    folder: RunFolder
    out: Annotated[str | None, "DIR", "folder of the pictures (default: plots in the run folder)"] = None
    waterfall: Annotated[
        Signals,
        "amplitudes of a signal over time and frequency: SENSOR:COLUMN such as mwd:ax, history:bit_speed, probes:x_600; "
        "only what is asked for is drawn",
    ] = ()
    order: Annotated[bool, "with --waterfall: over the order of rotation instead of the frequency"] = False
    psd: Annotated[Signals, "power density of a signal over the frequency"] = ()
    segment: Annotated[
        str | None,
        "LENGTH",
        "length of a segment, such as '2 s'; with --order its revolutions (default: from the length of the run)",
    ] = None
    units: Units = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.plotting.run.plot import plot, spectra
        from drillpetsc.plotting.style import save_figures

        say_unfinished(self.folder)
        if self.order and not self.waterfall:
            raise CaseError(at="--order", want="--waterfall SIGNAL beside it")
        if self.segment is not None and not (self.waterfall or self.psd):
            raise CaseError(at="--segment", want="--waterfall SIGNAL or --psd SIGNAL beside it")
        with reading(self.folder):
            if not (self.waterfall or self.psd):
                return plot(self.folder, self.out, self.units)
            segment = self._segment()
            drawn = spectra(
                self.folder, self.waterfall, self.psd, order=self.order, segment=segment, units=self.units
            )
            return save_figures(drawn, Path(self.out or Path(self.folder) / "plots"))

    def _segment(self) -> float | None:
        """Length of a segment [s], or its revolutions."""
        from drillpetsc.units import to_si

        if self.segment is None:
            return None
        try:
            length = float(self.segment) if self.order else to_si(self.segment, "s")
        except ValueError:
            length = 0.0
        if not 0 < length < 1e9:
            want = "a number of revolutions above 0" if self.order else "a time above 0, such as '2 s'"
            raise CaseError(at="--segment", got=self.segment, want=want)
        return length


class Serve(Operation):
    """A page in the browser: a run with its string in the hole, live while it is written; or the form of a case."""

    path: Annotated[
        str, Mark.ARGUMENT, "RUN|CASE.yaml", "a run folder, which may still be empty; or a case file"
    ]
    port: Annotated[
        int, holds(lambda port: 0 <= port < 65536, "a port, 0 to 65535"), "N", "port; 0: any free one"
    ] = 8765
    host: Annotated[
        str,
        "NAME",
        "address to listen at; any other than the default lets other machines in, if they have the whole address of the page",
    ] = "127.0.0.1"
    no_open: Annotated[bool, "do not open the page in the browser"] = False
    export: Annotated[
        str | None,
        "FILE.html",
        "write the page of a run with all its data to a file, which needs no server, and end",
    ] = None
    units: Units = None

    def compute(self, job: Any) -> Any:
        if world_rank() != 0:
            return []
        path = Path(self.path)
        if path.is_dir():
            return self._run()
        if not path.is_file():
            raise CaseError(at="RUN|CASE.yaml", got=self.path, want="a run folder or a case file that exists")
        if self.export is not None:
            raise CaseError(
                at="--export", got=self.path, want="a run folder: the form of a case needs the server"
            )
        from drillpetsc.browser.case_form import CaseForm
        from drillpetsc.browser.server import case_server, serve

        initialise_petsc()  # for the answer of check
        serve(case_server(self.host, self.port, CaseForm(path, self.units)), not self.no_open)
        return []

    def _run(self) -> list[str]:
        """Serve or export the page of a run."""
        from drillpetsc.browser.page import export_page
        from drillpetsc.browser.run_source import RunSource
        from drillpetsc.browser.server import run_server, serve
        from drillpetsc.operations.cases import writing

        inside = runs_in(Path(self.path))
        if inside:
            want = f"one run folder, such as {inside[0]}"
            raise CaseError(at="RUN", got=f"{self.path}, which holds {len(inside)} of them", want=want)
        source = RunSource(self.path, self.units)
        if self.export is None:
            serve(run_server(self.host, self.port, source), not self.no_open)
            return []
        text, remarks = export_page(source)
        with writing(self.export, "--export"):
            Path(self.export).write_text(text, encoding="utf-8")
        size = Path(self.export).stat().st_size
        return [f"{self.export}  ({size / 1e6:.1f} MB)", *(f"  note: {text}" for text in remarks)]


class Vibration(Operation):
    """Indices of drilling dynamics of a run: stick-slip, vibration, specific energy, whirl; writes indices.csv."""

    folder: RunFolder
    window: Annotated[str | None, TIME, "TIME", "length of a window (default: the case's, else 20 s)"] = None
    every: Annotated[
        str | None,
        TIME,
        "TIME",
        "time between the ends of two windows (default: the case's, else 1 s)",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.results import open_run

        say_unfinished(self.folder)
        return open_run(self.folder).find_indices(self.window, self.every)  # type: ignore[arg-type]  # read: seconds


class Report(Operation):
    """One HTML file on a case and its run folders: well, string, mud, results, inputs with sources."""

    paths: Annotated[
        tuple[str, ...],
        Mark.ARGUMENT,
        "RUN|CASE.yaml",
        "run folders of one case, and its file; or the file alone",
    ]
    out: Annotated[
        str | None,
        "FILE.html",
        "file to be written (default: report.html in the first run folder, or CASE-report.html)",
    ] = None
    sections: Annotated[
        Names | None,
        names,
        "A,B",
        "well, string, mud, roadmap, statics, limits, hydraulics, surge, dynamics, modes, inputs, solver (default: all)",
    ] = None
    interactive: Annotated[
        bool,
        "pictures of lines and bars zoom in a browser, by a script in the file (4.5 MB more; needs the package plotly)",
    ] = False
    units: Units = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.reporting import report

        with reading(*self.paths):
            file = report(
                *self.paths,
                out=self.out,
                units=self.units,
                sections=self.sections or (),
                interactive=self.interactive,
            )
        return [f"{file}  ({file.stat().st_size / 1e6:.2f} MB)"]


class Export(Operation):
    """Tables of a run folder for other programs: CSV, xlsx or LAS, with units and headers as engineers write them."""

    folder: RunFolder
    out: Annotated[str | None, "DIR", "folder of the files (default: export in the run folder)"] = None
    format: Annotated[Literal["csv", "xlsx", "las", "parquet"], "format of the files"] = "csv"
    columns: Annotated[
        Names | None,
        names,
        "A,B",
        "names of columns, such as hook_load,wob; time or depth goes along (default: all)",
    ] = None
    units: Units = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.reporting import export

        say_unfinished(self.folder)
        if self.columns is not None and not self.columns:
            raise CaseError(at="--columns", got=",", want="names of columns, such as hook_load,wob")
        columns = self.columns or ()
        files, remarks = export(self.folder, self.out, units=self.units, format=self.format, columns=columns)
        return [*files, *(f"  note: {text}" for text in remarks)]


def runs_in(folder: Path) -> list[Path]:
    """Run folders in a folder that is not one itself, such as the folder of a sweep."""
    from drillpetsc.output import RunFolder

    if RunFolder(folder).case.is_file():
        return []
    return sorted(inner for inner in folder.iterdir() if inner.is_dir() and RunFolder(inner).case.is_file())


def say_unfinished(run: str) -> None:
    """Say of the folder of a run that it did not reach its end: what is shown of it stops somewhere."""
    from drillpetsc.output import RunFolder, read_summary

    folder = RunFolder(Path(run))
    if not folder.history.is_file():
        return
    status = "there is no summary.json"
    if folder.summary.is_file():
        status = read_summary(folder.summary).get("status", "done")
    if status != "done":
        print(f"drillpetsc: {run}: the run is not complete: {status}", file=sys.stderr)


def depth(text: str) -> float:
    """A depth [m] of --interval."""
    from drillpetsc.units import to_si

    try:
        return to_si(text if text.strip()[-1:].isalpha() else f"{text} m", "m")
    except ValueError:
        raise CaseError(at="--interval", got=text, want="a depth such as 1200, or '4000 ft'") from None
