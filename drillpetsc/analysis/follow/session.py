"""The command `follow`: from the rows of a log to follow.csv, state.json and live.html, and again after a restart."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from drillpetsc.analysis.commands.import_log import measured_point, weights
from drillpetsc.analysis.follow.advice import STIFF, models_told, told
from drillpetsc.analysis.follow.alarms import INSIDE
from drillpetsc.analysis.follow.beam import Model
from drillpetsc.analysis.follow.follower import Follower, Reading, Update
from drillpetsc.analysis.follow.live import write_page
from drillpetsc.analysis.follow.readers import Reader, reader_of
from drillpetsc.analysis.follow.strings import SLIPS, Load
from drillpetsc.analysis.follow.stuck import StuckPoints, stuck_told
from drillpetsc.analysis.follow.update_table import READINGS, UpdateTable, columns_of
from drillpetsc.analysis.loads.torque_drag.operations import load_of, plan_of
from drillpetsc.analysis.loads.torque_drag.readings.reading import corrected_points
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.errors import CaseError
from drillpetsc.logs.growing import GrowingLog
from drillpetsc.logs.log import Log, read_map
from drillpetsc.logs.points import Point
from drillpetsc.logs.pulls import Pull
from drillpetsc.logs.quality import check_sizes
from drillpetsc.output.files.json_file import read_summary, write_summary
from drillpetsc.output.files.run_folder import FOLLOW_PAGE, FOLLOW_STATE, FOLLOW_TABLE, RunFolder, make_folder
from drillpetsc.output.files.tables import header
from drillpetsc.output.job import Job, RunResult
from drillpetsc.unit_systems import duration, shown
from drillpetsc.unit_tables import FOOT

CHECKED_ROWS = 200  # rows whose sizes are compared with the computed weight
WRITTEN_EACH = 2.0  # seconds between states and pages
STOPPED_AFTER = 60.0  # seconds without a row after which the feed has stopped
SLIPS_NOISE = 6e3  # standard error of the weight in slips: the scatter from one connection to the next [N]
DEEPER = 1.1  # of the hole's end: a log that begins further down has other units, or is of another well
KEPT_ALARMS = 200
STUCK = "stuck"
ZERO = "was zero, as if the sensor were dead, and was left out"
BEYOND = "a reading was beyond what a rig can have, and the row was left out: another unit?"
NO_STRING = "the case has no string at that bit depth, and the row was left out"
BELOW = (
    "the bit was below the end of the case's hole, and the row was left out: extend well.survey to the bit"
)

#: what runs if the reading is not zero
_WITH = {"torque": "rpm", "pump_pressure": "flow_rate"}


@dataclass(frozen=True)
class Choices:
    """Options of the command: --log, --map, --prior, --every [m], --speed, --wait [s], --until [s or m], --restart, --model."""

    log: str
    mapping: tuple[str, ...] = ()
    priors: dict[str, tuple[float, float]] = field(default_factory=dict)
    every: float = 1.0
    speed: float | None = None
    wait: float = 0.0
    until: float | None = None
    restart: bool = False
    model: Model = "soft"


def run_follow(job: Job, choices: Choices) -> RunResult:
    """Follow a rig's log until it ends, or no row has come for ``wait`` seconds, or the user stops it."""
    if job.comm.size > 1:
        raise CaseError(
            at="mpirun",
            got=f"{job.comm.size} processes",
            want="one process: a row is a few milliseconds of work",
        )
    reader = reader_of(choices.log, read_map(choices.mapping), choices.wait > 0)
    with options_of(job.case):
        session = _Session(job, choices, reader)
        try:
            session.run()
        except KeyboardInterrupt:
            if session.folder is None:
                raise
            session.feed = "stopped by the user; --restart continues"
    return session.result()


class _Session:
    def __init__(self, job: Job, choices: Choices, reader: Reader) -> None:
        self.job, self.case, self.choices, self.reader = job, job.case, choices, reader
        rig = self.case.rig
        self.block = None if rig is None else rig.block_weight
        self.follower = Follower(self.case, self.block or 0.0, choices.priors, choices.model)
        self.growing: GrowingLog | None = None
        self.first: list[Log] = []  # rows until their sizes are checked
        self.updates: list[Update] = []
        self.alarms: list[dict[str, Any]] = []
        self.differences: list[dict[str, Any]] = []  # of the models
        self.stuck = StuckPoints(self.follower)
        self.differ: list[str] = []  # operations and readings in which they do at present
        self.score = {name: _Score() for name, _ in READINGS}
        self.feed, self.rows, self.finished = "running", 0, False
        self.unused: Counter[str] = (
            Counter()
        )  # points that were left out, or a reading of them, by the reason
        self.last_row = self.last_written = time.monotonic()
        self.clock: tuple[float, float] | None = None  # (wall time, log time) of the first row that is paced
        self.folder: RunFolder | None = None
        self.table: UpdateTable
        self.position, self.since_position = (
            reader.position(),
            0,
        )  # before the rows at hand, and how many of them are taken
        self.skip = 0  # rows that were taken before a restart
        if choices.restart:
            self._go_on()

    # ------------------------------------------------------------------ rows
    def run(self) -> None:
        """Take rows until the end."""
        while not self.reader.ended and not self.finished:
            if not self.first:
                self.position, self.since_position = self.reader.position(), 0
            log = self.reader.read()
            if log is not None and self.skip:
                log, self.skip = log.rows(np.arange(self.skip, len(log))), max(self.skip - len(log), 0)
                log = log if len(log) else None
            now = time.monotonic()
            if log is not None:
                self.last_row, self.feed = now, "running"
                self._take(log)
            elif now - self.last_row > STOPPED_AFTER:
                self.feed = f"stopped: no row for {duration(now - self.last_row)}{self._trouble()}"
            if self.choices.wait and now - self.last_row > self.choices.wait:
                break
            if log is None and not self.reader.ended:
                time.sleep(0.2)
            if now - self.last_written > WRITTEN_EACH:
                self._write(now)
        if self.first:
            self._check_sizes()
        if self.growing is not None:
            self._write(time.monotonic())  # a restart continues before the rows that wait for others
            self._points(self.growing.finish())
        self.feed = f"ended{self._trouble()}"
        if self.growing is None:
            left = ", ".join(f"{count} {reason}" for reason, count in self.reader.left_out.items())
            got = f"no row ({left})" if left else "no row"
            raise CaseError(at="--log", got=got, want="a log with rows", hint=self.choices.log)

    def _trouble(self) -> str:
        return f" ({self.reader.trouble})" if self.reader.trouble else ""

    def _take(self, log: Log) -> None:
        if self.growing is None or self.first:
            self.first.append(log)
            if sum(map(len, self.first)) >= CHECKED_ROWS:
                self._check_sizes()
            return
        self._add(log)

    def _check_sizes(self) -> None:
        """Refuse units that are wrong by the size of the readings; then the rows that were kept are followed."""
        names = self.first[0].values
        whole = Log(
            {name: np.concatenate([q.values[name] for q in self.first]) for name in names}, self.first[0].titles,
            self.first[0].start, frozenset(q.partition("=")[0] for q in self.choices.mapping),
        )  # fmt: skip
        weigh = weights(self.case, np.array([0.0, float(self.case.given_well.survey.md[-1])]))
        self.follower.strings.remarks += check_sizes(whole, lambda depth: weigh(depth) + (self.block or 0.0))
        shallowest, end = float(np.nanmin(whole.values["bit_depth"])), self.follower.end
        if shallowest > DEEPER * end:
            raise CaseError(
                at="bit_depth", got=f"{shallowest:.0f} m and more in the first {len(whole)} rows",
                want=f"up to {end:.0f} m, where the hole of the case ends",
                hint="are depths in feet?" if FOOT * shallowest < DEEPER * end else "extend well.survey to the bit",
            )  # fmt: skip
        if whole.by_time and self.block is None:
            raise CaseError(
                at="rig.block_weight",
                want="the weight of block and top drive: by it the log shows when the string is in slips",
            )
        kept, self.first = self.first, []
        if self.growing is None:
            self.growing = GrowingLog(weigh, self.block, self.choices.every, self.reader.titles)
        if self.folder is None:  # nothing can be refused any more
            self.folder = self.job.make_folder()
            self.folder.write_case(self.case)
            self.table = UpdateTable(self.folder.path / FOLLOW_TABLE, self.follower.states, None)
        for log in kept:
            self._add(log)

    def _add(self, log: Log) -> None:
        assert self.growing is not None
        for part in self._paced(log):
            self.rows += len(part)
            self.since_position += len(part)
            self._points(self.growing.add(part))

    def _paced(self, log: Log) -> Iterator[Log]:
        """The rows when they are due: at once without --speed; rows after --until end it."""
        index = log.index
        if self.choices.until is not None and (index > self.choices.until).any():
            log = log.rows(np.cumsum(index > self.choices.until) == 0)
            self.finished = True
        if self.choices.speed is None or not log.by_time or not len(log):
            yield from [log] if len(log) else []
            return
        self.clock = self.clock or (time.monotonic(), float(log.values["time"][0]))
        wall, first = self.clock
        for i, moment in enumerate(log.values["time"].tolist()):
            due = wall + (moment - first) / self.choices.speed
            if due > time.monotonic():
                self._write(time.monotonic(), page_only=True)
                time.sleep(max(due - time.monotonic(), 0.0))
            yield log.rows(np.array([i]))

    def _points(self, points: list[tuple[Point | Pull, float]]) -> None:
        for point, moment in points:
            if isinstance(point, Pull):
                self._pull(point, moment)
                continue
            if point.bit_depth > self.follower.end + 1e-6:
                self.unused[BELOW] += 1
                continue
            if point.operation != SLIPS and not self.follower.strings.exists(point.bit_depth):
                self.unused[NO_STRING] += 1
                continue
            try:
                reading = self._reading(point, moment)
            except CaseError:
                self.unused[BEYOND] += 1
                continue
            update = self.follower.see(reading)
            self.updates.append(update)
            del self.updates[:-4000]
            for alarm in update.alarms:
                words = told(self.case, alarm, update, self.follower)
                self._tell(self.alarms, "ALARM", moment, alarm.kind, words)
            self._compare(update)
            for name, error in update.forecast.items():
                self.score[name].add(error.reading, error.forecast, error.sd, update.last.get(name, math.nan))
            self.table.add(update)

    def _tell(self, kept: list[dict[str, Any]], head: str, moment: float, kind: str, words: str) -> None:
        when = self._when(moment)
        kept.append({"row": self.follower.number, "when": when, "kind": kind, "text": words})
        del kept[:-KEPT_ALARMS]
        print(" ".join(filter(None, (head, when, words))), flush=True)

    def _pull(self, pull: Pull, moment: float) -> None:
        """Say where the string is stuck, if a pull shows it."""
        if not self.follower.strings.exists(pull.bit_depth):
            return
        found = self.stuck.see(pull)
        if found is not None:
            self._tell(self.alarms, "ALARM", moment, STUCK, stuck_told(self.case, pull, found))

    def _compare(self, update: Update) -> None:
        """Say that the models differ when they begin to do so."""
        if update.compared is None:
            return
        found = {
            f"{update.reading.load.operation} {name}": words
            for name, words in models_told(self.case, update).items()
        }
        for words in (words for key, words in found.items() if key not in self.differ):
            self._tell(self.differences, "MODELS", update.reading.time, STIFF, words)
        self.differ = [key for key in self.differ if not key.startswith(f"{update.reading.load.operation} ")]
        self.differ += found

    def _reading(self, point: Point, moment: float) -> Reading:
        values = self._live(point.values)
        if point.operation == SLIPS:
            scatter = max(point.scatter["hook_load"], SLIPS_NOISE)
            return Reading(
                Load(SLIPS, point.bit_depth),
                moment,
                values.get("hook_load", math.nan),
                math.nan,
                hook_scatter=scatter,
            )
        own = load_of(self.case, plan_of(self.case), point.operation)
        speed = abs(own.axial_velocity) if math.isnan(point.speed) else point.speed
        on_bottom = point.operation in ("drilling", "sliding")
        wob = self._corrected_weight(point) if on_bottom else 0.0
        load = Load(
            point.operation, point.bit_depth, wob, values.get("torque_downhole", math.nan) if on_bottom else 0.0,
            math.copysign(speed, own.axial_velocity) if own.axial_velocity else 0.0,
            values.get("rpm", own.rotation), values.get("flow_rate", 0.0),
        )  # fmt: skip
        blind = on_bottom and "wob" not in values  # the hook load does not show friction then
        return Reading(
            load, moment, math.nan if blind else values.get("hook_load", math.nan), values.get("torque", math.nan),
            values.get("pump_pressure", math.nan), point.scatter.get("hook_load", 0.0), point.scatter.get("torque", 0.0),
            "torque_downhole" in values,
        )  # fmt: skip

    def _live(self, values: dict[str, float]) -> dict[str, float]:
        """The readings without those of dead sensors: a string on the hook has a weight, and one that turns has a torque."""
        dead = [name for name in ("hook_load", "torque", "pump_pressure") if values.get(name) == 0.0]
        dead = [name for name in dead if name == "hook_load" or values.get(_WITH[name], 0.0) != 0.0]
        self.unused.update(f"{name.replace('_', ' ')} {ZERO}" for name in dead)
        return {name: value for name, value in values.items() if name not in dead}

    def _corrected_weight(self, point: Point) -> float:
        """Weight on bit in place of that read: of its zero, and of the pressure drop of the bit."""
        found = corrected_points(self.case, [measured_point(point)], False)[0].wob
        return float(found or 0.0)

    def _when(self, moment: float) -> str:
        if math.isnan(moment):
            return ""
        if self.reader.start is None:
            return str(timedelta(seconds=round(moment)))
        return (self.reader.start + timedelta(seconds=moment)).isoformat(timespec="seconds")

    # ------------------------------------------------------------------ files
    def _write(self, now: float, page_only: bool = False) -> None:
        """Write the page, and the state from which a restart continues, which belongs to the rows read so far."""
        if self.folder is None or page_only and now - self.last_written < WRITTEN_EACH:
            return
        self.last_written = now
        self.table.flush()
        if not page_only and not self.first:
            write_summary(self.folder.path / FOLLOW_STATE, self._state())
        self._page()

    def _state(self) -> dict[str, Any]:
        assert self.growing is not None
        return {
            "log": self.choices.log, "feed": self.feed, "written": datetime.now(UTC).isoformat(timespec="seconds"),
            "estimate": self._estimate(), "alarms": self.alarms, "differences": self.differences, "differ": self.differ, "stuck": self.stuck.last, "position": self.position if self.finished else self.reader.position(),
            "skip": self.since_position if self.finished else 0, "rows": self.rows,
            "titles": self.reader.titles, "unused": dict(self.unused), "score": {name: q.__dict__ for name, q in self.score.items()},
            "growing": self.growing.saved(), "follower": self.follower.saved(),
        }  # fmt: skip

    def _estimate(self) -> dict[str, dict[str, float]]:
        belief = self.follower.belief
        return {
            q.name: {"mean": float(m), "sd": float(s)}
            for q, m, s in zip(self.follower.states, belief.mean, belief.sd, strict=True)
        }

    def _page(self) -> None:
        assert self.folder is not None
        write_page(
            self.folder.path / FOLLOW_PAGE, self.case, self.feed, self.updates, self.follower,
            sorted(self.alarms + self.differences, key=lambda q: int(q["row"])),
        )  # fmt: skip

    def _go_on(self) -> None:
        """Continue a folder: its state, and the rows of its table that belong to it."""
        self.folder = make_folder(self.job.comm, self.job.name, self.job.out, True, False)
        path = self.folder.path / FOLLOW_STATE
        if not path.is_file():
            raise CaseError(
                at="--restart", got=self.folder.path, want=f"a folder of follow, with {FOLLOW_STATE}"
            )
        saved = read_summary(path)
        with open(self.folder.path / FOLLOW_TABLE, encoding="utf-8") as table:
            if table.readline().strip().split(",") != header(columns_of(self.follower.states)):
                raise CaseError(
                    at="--restart", got="a case with other friction groups, or a folder of another version of the program",
                    want="the case and the version of the folder",
                )  # fmt: skip
        self.reader.go_on_from(saved["position"])
        self.skip = saved["skip"]
        weigh = weights(self.case, np.array([0.0, float(self.case.given_well.survey.md[-1])]))
        self.growing = GrowingLog(weigh, self.block, self.choices.every, saved["titles"])
        self.growing.restore(saved["growing"])
        self.follower.restore(saved["follower"])
        self.rows, self.alarms, self.unused = saved["rows"], saved["alarms"], Counter(saved["unused"])
        self.differences, self.differ = saved["differences"], saved["differ"]
        self.stuck.last = saved["stuck"]
        self.score = {name: _Score(**values) for name, values in saved["score"].items()}
        self.table = UpdateTable(self.folder.path / FOLLOW_TABLE, self.follower.states, self.follower.number)

    def result(self) -> RunResult:
        """Write the summary; the lines say what was found."""
        assert self.folder is not None
        self.table.close()
        self._page()
        growing, beam = self.growing, self.follower.beam
        summary = {
            "title": self.case.title, "units": self.case.shown_units, "feed": self.feed, "rows": self.rows,
            "rows_dropped_for_depth": 0 if growing is None else growing.dropped, "rows_left_out": dict(self.reader.left_out),
            "updates": self.follower.number, "forecast": {k: q.figures() for k, q in self.score.items() if q.n},
            "estimate": self._estimate(), "alarms": self.alarms, "warnings": self._warnings(), "notes": [*self.reader.remarks, *self.follower.strings.remarks, *beam.remarks],
            "model": self.choices.model, "model_differences": self.differences, "beam_seconds": beam.seconds,
        }  # fmt: skip
        write_summary(self.folder.summary, summary)
        return RunResult(self.folder.path, summary, self._lines(summary))

    def _warnings(self) -> list[str]:
        if self.follower.number:
            return [f"in {count} rows of the estimate {what}" for what, count in self.unused.items()]
        return ["no row was used: the log shows neither drilling, trips, rotation off bottom nor slips"]

    def _lines(self, summary: dict[str, Any]) -> list[str]:
        units = self.case.shown_units
        lines = [
            f"{self.case.title or 'case'}: follow, {self.rows} rows, {self.follower.number} updates; feed {self.feed}"
        ]
        lines += [f"  left out: {count} {reason}" for reason, count in summary["rows_left_out"].items()]
        for name, found in summary["forecast"].items():
            last = found["rms_of_last_value"]
            lines.append(
                f"  {name.replace('_', ' ')} one stand ahead: rms {found['rms']:.2%}, last value {'-' if math.isnan(last) else f'{last:.2%}'}, "
                f"{found['inside_90']:.0%} of {found['n']} inside the 90 % band"
            )
        kinds = {"block_weight": "force", "hook_error": "force"}
        for name, found in summary["estimate"].items():
            if name in ("hook_error", "torque_error", "bit_torque", "running_drag"):
                continue
            mean, sd = (
                shown(found[key], kinds[name], units) if name in kinds else f"{found[key]:.3g}"
                for key in ("mean", "sd")
            )
            lines.append(f"  {name}: {mean} +- {sd}")
        assert self.folder is not None
        lines += [f"  WARNING: {q}" for q in summary["warnings"]]
        if seconds := self.follower.beam.seconds:
            lines.append(
                f"  stiff string: {len(seconds)} states, {np.mean(seconds):.1f} s each, the longest {max(seconds):.1f} s; "
                f"beyond the band of the soft one {len(self.differences)} times"
            )
        lines += [f"  alarms: {len(self.alarms)}", *(f"  note: {q}" for q in summary["notes"])]
        return [*lines, f"  results: {self.folder.path}: {FOLLOW_TABLE}, {FOLLOW_STATE}, {FOLLOW_PAGE}"]


@dataclass
class _Score:
    """How good the forecasts made one stand earlier were; sums over n rows."""

    n: int = 0
    square: float = 0.0
    inside: int = 0
    last_n: int = 0
    last_square: float = 0.0

    def add(self, reading: float, forecast: float, sd: float, last: float) -> None:
        self.n += 1
        self.square += _relative(reading, forecast) ** 2
        self.inside += abs(reading - forecast) <= INSIDE * sd
        if math.isfinite(last):
            self.last_n += 1
            self.last_square += _relative(reading, last) ** 2

    def figures(self) -> dict[str, float]:
        last = math.sqrt(self.last_square / self.last_n) if self.last_n else math.nan
        return {
            "n": self.n,
            "rms": math.sqrt(self.square / self.n),
            "inside_90": self.inside / self.n,
            "rms_of_last_value": last,
        }


def _relative(reading: float, wanted: float) -> float:
    """Difference over the reading; over ``wanted`` if the reading is zero, as the torque of a string that does not turn."""
    size = abs(reading) or abs(wanted)
    return (reading - wanted) / size if size else 0.0
