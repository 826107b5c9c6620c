"""What the page of a run shows, from its files, in the units of the reader: only what is new goes to the page.

Numbers travel as base64 of little-endian float32 (times: float64).
"""

from __future__ import annotations

import base64
import contextlib
import os
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.case import Case, load_case
from drillpetsc.errors import DrillError
from drillpetsc.output.files.fields import read_series
from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.lock import writer_of
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.tables import read_table, read_titles
from drillpetsc.output.files.vtk import Frame, read_frame
from drillpetsc.output.shown_units import unit_of
from drillpetsc.plotting import style
from drillpetsc.plotting.run.place import Wall, place_of, read_wall
from drillpetsc.plotting.run.plot import grouped
from drillpetsc.reporting.units import label_of
from drillpetsc.unit_systems import System


class Tail:
    """The rows of a CSV table of numbers that a run may be writing.

    titles: of its columns.
    damaged: number of rows that cannot be read and are left out.
    series: a name of the file; it changes if the file is replaced, and rows count from 0 again.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._forget()

    def _forget(self) -> None:
        self.titles: list[str] = []
        self.damaged = 0
        self.series, self._offset, self._rows, self._parts = "", 0, 0, list[np.ndarray]()

    def read(self) -> str:
        """Read what is new; returns the series.  Raises ValueError for a file without a header."""
        try:
            state = os.stat(self.path)
        except FileNotFoundError:
            self._forget()
            return ""
        series = f"{state.st_dev}-{state.st_ino}"
        if series != self.series or state.st_size < self._offset:
            self._forget()
            self.titles = read_titles(self.path)
            self.series = series
        with open(self.path, "rb") as file:
            file.seek(self._offset)
            new = file.read()
        whole = new.rfind(b"\n") + 1  # the last row may be half written
        lines = new[:whole].decode("utf-8", errors="replace").splitlines()
        if self._offset == 0:
            lines = lines[1:]
        self._offset += whole
        rows = [row for row in (_numbers(line, len(self.titles)) for line in lines) if row is not None]
        if rows:
            self._parts.append(np.array(rows))
            self._rows += len(rows)
        self.damaged += len(lines) - len(rows)
        return self.series

    def __len__(self) -> int:
        return self._rows

    def rows(self, first: int, last: int) -> np.ndarray:
        """Rows (last - first, columns)."""
        if len(self._parts) > 1:
            self._parts = [np.concatenate(self._parts)]
        return self._parts[0][first:last] if self._parts else np.zeros((0, len(self.titles)))

    @property
    def last_time(self) -> float | None:
        """The first value of the last row; None without rows."""
        return float(self._parts[-1][-1, 0]) if self._parts else None


def _numbers(line: str, count: int) -> list[float] | None:
    """The numbers of a row, None if they are not ``count`` numbers."""
    words = line.split(",")
    try:
        return [float(word) for word in words] if len(words) == count else None
    except ValueError:
        return None


PLACE = ("md [m]", "outer_radius [m]", "hole_radius [m]", "offset_x [m]", "offset_y [m]")
DISTANCE = "distance_from_centre [m]"
MOST_ROWS = 50_000  # of a history in one answer: the page asks again for the others
MOST_FRAMES = 120  # read in one answer for the ranges of the colours


def packed(values: Any, kind: str = "<f4") -> str:
    """Numbers (n,) as text for the page."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def shown(title: str, values: Any, units: System) -> np.ndarray:
    """Values (n,) of a column [SI] in the unit of an axis."""
    size, zero, _ = unit_of(title, units, True)
    return (np.asarray(values, dtype=float) - zero) / size


class RunSource:
    """Reads a run folder again and again, while a run may write there; safe for several threads.

    path: the run folder, which may be empty, and may go and come back; units: of the page, by default the case's.
    """

    def __init__(self, path: str | Path, units: System | None = None) -> None:
        self.folder, self._units = RunFolder(Path(path)), units
        self._lock = threading.Lock()
        self._history = Tail(self.folder.history)
        self._series = ""
        self._ranges: dict[str, list[float]] = {}
        self._ranged: set[Path] = set()
        self._case: tuple[int, Case | None] = (0, None)
        self._hole: tuple[str, Wall | None] = ("", None)
        self._frames: tuple[Any, list[tuple[float, Path]]] = (None, [])
        self._faults: dict[str, str] = {}  # by file: what is wrong with it, until it is read well

    # ------------------------------------------------------------------ what is new
    def news(self, series: str = "", rows: int = 0, hole: str = "") -> dict[str, Any]:
        """State of the run, the rows after the first ``rows``, and the hole unless the page has it.

        series, hole: what the page has, as an earlier answer named it.
        """
        with self._lock:
            self._try("history.csv", self._history.read, None)
            case, units, series_now = self._read_case(), self.units, self._name_series()
            first = rows if series == series_now else 0
            last = min(first + MOST_ROWS, len(self._history))
            frames = self._try("string.pvd", self._read_series, [])
            self._read_ranges(frames)
            wall = self._wall()
            hole_now = self._hole[0] if wall is not None else ""
            depth, lateral = (unit_of(name, units) for name in ("md [m]", "offset_x [m]"))
            title = self._summary().get("title") or (case.title if case is not None else "")
            answer: dict[str, Any] = {
                "series": series_now,
                "status": self._status(case),
                "title": title or self.folder.path.resolve().name,
                "folder": str(self.folder.path),
                "first": first,
                "rows": last,
                "more": last < len(self._history),
                "columns": self._columns(first, last, units),
                "panels": self._panels(),
                "times": [time for time, _ in frames],
                "fields": self._fields(units),
                "depth": depth[2],
                "lateral": lateral[2],
                "lateral_per_depth": depth[0] / lateral[0],
                "hole": hole_now,
            }
            if wall is not None and hole_now != hole:
                answer["wall"] = _packed_wall(wall, depth[0], lateral[0])
            answer["notes"] = self._notes()
            return answer

    @property
    def units(self) -> System:
        """Units in which the page shows numbers."""
        found = None
        with contextlib.suppress(OSError, ValueError):  # of a damaged case.yaml, which is named elsewhere
            found = style.units_of_run(self.folder.case)
        return self._units or found or "metric"

    def frame(self, number: int) -> dict[str, Any]:
        """One frame of the string.  Raises ValueError if there is none, or if it is damaged."""
        with self._lock:
            series = self._read_series()
            if not 0 <= number < len(series):
                raise ValueError(f"frame {number}: the run has {len(series)}")
            time, file = series[number]
            frame, units = self._with_statics(read_frame(file)), self.units
            place = place_of(frame, self._wall())
            depth, lateral = unit_of("md [m]", units)[0], unit_of("offset_x [m]", units)[0]
            arrays: dict[str, np.ndarray] = {
                "md": place.md / depth,
                "ox": place.offset[:, 0] / lateral,
                "oy": place.offset[:, 1] / lateral,
                **{
                    key: frame.point_data[name] / lateral
                    for key, name in (("radius", "outer_radius [m]"), ("hole", "hole_radius [m]"))
                    if name in frame.point_data
                },
                **{f"c{k}": place.centre[:, k] / depth for k in range(3)},
                **{f"l{k}": place.lateral[:, k] / depth for k in range(3)},
                **{f"f:{name}": shown(name, values, units) for name, values in self._values(frame).items()},
            }
            return {"number": number, "time": time, "arrays": {key: packed(v) for key, v in arrays.items()}}

    # ------------------------------------------------------------------ parts
    def _try(self, what: str, read: Callable[[], Any], otherwise: Any) -> Any:
        """The value of ``read``; what is wrong with a file becomes a note."""
        try:
            found = read()
            self._faults.pop(what, None)
            return found
        except (OSError, ValueError, SyntaxError, KeyError, DrillError) as error:  # SyntaxError: of XML
            self._faults[what] = f"{what} cannot be read: {' '.join(str(error).split())}"
            return otherwise

    def _notes(self) -> list[str]:
        """What is wrong with files that are there, or that should be."""
        lost, folder = self._history.damaged, self.folder.path
        for file in list(self._faults):
            if not folder.is_dir() or not (file.startswith("string/") or (folder / file).exists()):
                del self._faults[file]
        rows = [f"history.csv: damaged rows that are left out: {lost}"] if lost else []
        return [*self._faults.values(), *rows]

    def _name_series(self) -> str:
        """A name for the results in the folder: another one when they were begun anew."""
        name = self._history.series
        if not name and self.folder.summary.is_file():
            name = str(self.folder.summary.stat().st_mtime_ns)
        if name != self._series:
            self._series, self._ranges, self._ranged = name, {}, set()
            self._faults = {
                file: text for file, text in self._faults.items() if not file.startswith("string/")
            }
        return name

    def _read_case(self) -> Case | None:
        """The case of the run, read again when its file has changed."""
        if not self.folder.case.is_file():
            return None
        changed = self.folder.case.stat().st_mtime_ns
        if changed != self._case[0]:
            self._case = changed, self._try("case.yaml", lambda: load_case(self.folder.case), None)
        return self._case[1]

    def _summary(self) -> dict[str, Any]:
        if not self.folder.summary.is_file():
            return {}
        return self._try("summary.json", lambda: read_summary(self.folder.summary), {})

    def _status(self, case: Case | None) -> dict[str, str]:
        """A word for the state of the run, and a sentence."""
        if not self.folder.path.is_dir():
            return {"word": "missing", "text": f"the run folder {self.folder.path} is gone: moved or removed"}
        if writer_of(self.folder.path) is not None:
            end = case.time.end if case is not None and case.time is not None else None
            until = f" of {end:.6g} s" if end is not None else ""
            at = self._history.last_time
            return {
                "word": "running",
                "text": "running: no rows yet" if at is None else f"running: {at:.5g} s{until}",
            }
        summary = self._summary()
        status = str(summary.get("status", "done"))
        if summary and status == "done":
            return {"word": "done", "text": "finished"}
        if summary:
            return {"word": "stopped" if summary.get("interrupted") else "failed", "text": status}
        if len(self._history):
            cure = "; run --restart continues it" if self.folder.checkpoint.is_file() else ""
            return {"word": "failed", "text": f"broken off: no process writes here any more{cure}"}
        return {"word": "empty", "text": "no results in this folder yet"}

    def _columns(self, first: int, last: int, units: System) -> dict[str, str]:
        """New rows of the history, by title."""
        rows = self._history.rows(first, last)
        return {
            title: packed(rows[:, 0], "<f8") if k == 0 else packed(shown(title, rows[:, k], units))
            for k, title in enumerate(self._history.titles)
        }

    def _panels(self) -> list[dict[str, Any]]:
        """Columns of the history that share a panel: those of the operation, then those of the numerics."""
        if len(self._history.titles) < 2:
            return []
        units = self.units
        return [
            {
                "unit": unit_of(panel[0], units, True)[2],
                "of": {q: label_of(q, units) for q in panel},
                "numerics": late,
            }
            for late, panels in enumerate(grouped(self._history.titles))
            for panel in panels
        ]

    def _fields(self, units: System) -> dict[str, dict[str, Any]]:
        """Quantities along the string, with their range over all frames."""
        out = {}
        for name, (low, high) in self._ranges.items():
            a, b = shown(name, [low, high], units).tolist()
            out[name] = {
                "label": label_of(name, units),
                "unit": unit_of(name, units, True)[2],
                "low": a,
                "high": b,
            }
        return out

    def _read_series(self) -> list[tuple[float, Path]]:
        """Times and files of the frames, read again when their list has changed."""
        file = self.folder.string_series
        state = file.stat() if file.is_file() else None
        changed = (state.st_mtime_ns, state.st_ino, state.st_size) if state is not None else None
        if changed != self._frames[0]:
            self._frames = changed, read_series(self.folder.path)
        return self._frames[1] if changed is not None else []

    def _read_ranges(self, frames: list[tuple[float, Path]]) -> None:
        """Widen the ranges by frames that were not read yet."""
        new = [file for _, file in frames if file not in self._ranged][:MOST_FRAMES]
        for file in new:
            self._ranged.add(file)
            frame = self._try(f"string/{file.name}", partial(read_frame, file), None)
            for name, values in self._values(self._with_statics(frame)).items() if frame is not None else ():
                finite = values[np.isfinite(values)]
                if finite.size:
                    low, high = self._ranges.get(name, (np.inf, -np.inf))
                    self._ranges[name] = [min(low, float(finite.min())), max(high, float(finite.max()))]

    def _with_statics(self, frame: Frame) -> Frame:
        """The frame of a static state with the columns of its table that it does not have."""
        if not self.folder.statics.is_file():
            return frame
        table = self._try("statics.csv", lambda: read_table(self.folder.statics), {})
        count = len(frame.points)
        more = {
            k: v
            for k, v in table.items()
            if k not in frame.point_data and len(v) == count and v.dtype.kind == "f"
        }
        return Frame(frame.points, {**frame.point_data, **more}, frame.cell_data, frame.cells)

    def _values(self, frame: Frame) -> dict[str, np.ndarray]:
        """Numbers (n,) at the nodes that a track or a colour can show [SI]."""
        data = frame.point_data
        fields = {
            k: np.asarray(v, dtype=float) for k, v in data.items() if k not in PLACE and np.ndim(v) == 1
        }
        return {**fields, DISTANCE: np.hypot(*place_of(frame, self._wall()).offset.T)}

    def _wall(self) -> Wall | None:
        """The hole; None without one."""
        changed = str(self.folder.well.stat().st_mtime_ns) if self.folder.well.is_file() else ""
        if changed != self._hole[0]:
            found = self._try("well.vtu", lambda: read_wall(self.folder.well), None) if changed else None
            self._hole = changed, found
        return self._hole[1]


def _packed_wall(wall: Wall, depth: float, lateral: float) -> dict[str, str]:
    """The hole for the page.  depth, lateral: sizes of the units along and across [m]."""
    along = {"md": wall.md, **{f"c{k}": wall.centre[:, k] for k in range(3)}}
    return {
        "radius": packed(wall.radius / lateral),
        **{name: packed(v / depth) for name, v in along.items()},
    }
