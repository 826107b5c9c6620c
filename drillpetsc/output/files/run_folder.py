"""The run folder: its location, its creation, and the names of the files in it."""

from __future__ import annotations

import os
import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output.files import lock
from drillpetsc.output.files.atomic import remove_leftovers
from drillpetsc.output.files.json_file import read_summary
from drillpetsc.parallel import first_rank_gives

SWEEP_TABLE = "sweep.csv"  # table of a sweep, in its folder
WELLS_TABLE = "wells.csv"  # table of a batch of several wells
LOSS_TABLE = "hydraulics.csv"  # losses by string item and hole section
NOZZLE_TABLE = "nozzles.csv"  # flow and power of the nozzles of bit and reamer
PROFILE_TABLE = "pressure_profile.csv"  # pressures along the depth
FLOW_CURVE_TABLE = "flow_curve.csv"  # losses and densities over the flow rate
SURGE_TABLE = "surge.csv"  # pressures of tripping
TRIP_SPEED_TABLE = "max_trip_speed.csv"  # largest speeds of tripping
READINGS_TABLE = "dial_readings.csv"  # viscometer readings of the mud
FITS_TABLE = "rheology_fits.csv"  # flow curves fitted to them
ROADMAP_TABLE = "roadmap.csv"  # hook load and torque by bit depth, operation and friction
ROADMAP_FILE = "roadmap.json"  # assumptions of the rows of a roadmap
CALIBRATION_TABLE = "calibration.csv"  # measured points beside the soft string with the fitted factors
CALIBRATION_SERIES = "calibration_series.csv"  # a log in time beside the run with the fitted numbers
MEASURED_TABLE = "measured.csv"  # measured points beside what the roadmap's case gives at each of them
SENSITIVITIES_TABLE = "sensitivities.csv"  # derivatives of outputs by numbers of the case
SENSITIVITIES_HISTORY = "sensitivities_history.csv"  # columns of a run and their derivatives, over time
UNCERTAIN_TABLE = "uncertain.csv"  # quantiles of outputs over samples of uncertain numbers
UNCERTAIN_LIMITS_TABLE = "uncertain_limits.csv"  # probabilities of passing a limit
UNCERTAIN_SHARES_TABLE = "uncertain_shares.csv"  # shares of these numbers in the variance
INDICES_TABLE = "indices.csv"  # indices of drilling dynamics over windows of time
REFLECTION_TABLE = "reflection.csv"  # of torsional waves at a controlled top
#: files of `import log`
LOG_TABLE, LOG_STATES, LOG_POINTS, LOG_QUALITY = "log.csv", "states.csv", "points.csv", "quality.json"
LOG_PAGE = "log.html"
FOLLOW_TABLE, FOLLOW_STATE, FOLLOW_PAGE = "follow.csv", "state.json", "live.html"  # of a rig that is followed
PARAVIEW_GRIDS = ("string", "contact", "mud")  # of the command `paraview`
PARAVIEW_FILES = (*(f"{name}.pvd" for name in PARAVIEW_GRIDS), "well.vtu", "scene.py")
RESPONSE_TABLE = "response.csv"  # forced harmonic response by speed and place
CAMPBELL_TABLE = "campbell.csv"  # modes by rotary speed
CRITICAL_TABLE = "critical.csv"  # critical speeds: intersections of excitation lines and modes
CRITICAL_MAP_TABLE = "critical_map.csv"  # critical speeds by stiffness of the wall
STABILITY_TABLE = "stability_map.csv"  # largest growth by rotary speed and weight on bit
BOUNDARY_TABLE = "stability_boundary.csv"  # speeds at which it changes its sign
STABILITY_RUNS_TABLE = "stability_runs.csv"  # what runs in time did, by rotary speed and weight on bit
LIMITS_TABLE = "limits.csv"  # stresses, strength and buckling along the string
CONTACTS_TABLE = "contacts.csv"  # loads of the wall on each item
SWEEP_PICTURES = ("trajectory", "inclination", "build_rate")  # of the new hole of a sweep, without .png
ABSENT = "-"  # in the table of a sweep: the value of a key whose block is switched off


class RunFolderExists(FileExistsError):
    """An explicit output folder exists and nobody said restart or overwrite."""


class RunFolderMissing(FileNotFoundError):
    """A run to be continued or read does not exist."""


class _Inside:
    """The path of a file or folder in a run folder."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, folder: RunFolder, _: type) -> Path:
        return folder.path / self.name


@dataclass(frozen=True)
class RunFolder:
    """One run's folder, with the paths of the contract, whether or not the files exist yet."""

    path: Path

    history = _Inside("history.csv")
    probes = _Inside("probes.csv")
    statics = _Inside("statics.csv")
    trajectory = _Inside("trajectory.csv")
    string_series = _Inside("string.pvd")
    string_frames = _Inside("string")
    sensors = _Inside("sensors")
    paraview = _Inside("paraview")
    well = _Inside("well.vtu")
    summary = _Inside("summary.json")
    checkpoint = _Inside("checkpoint.h5")
    case = _Inside("case.yaml")
    resolved_case = _Inside("case.resolved.yaml")
    report = _Inside("report.html")
    plots = _Inside("plots")

    @classmethod
    def create(
        cls,
        case_name: str,
        out: str | os.PathLike | None = None,
        *,
        restart: bool = False,
        overwrite: bool = False,
        results: str | os.PathLike = "results",
    ) -> RunFolder:
        """Make, or for a restart find, the folder of a run.

        without out         results/<case_name>-NNN, the next number above those that exist; made by one
        mkdir, so
                            two runs that start together get two folders. With restart: the latest such
                            folder.
        out, new            made, with its parents
        out, exists         RunFolderExists, unless restart (kept as it is) or overwrite (the files of the
        contract
                            are removed, others kept)
        restart, not there  RunFolderMissing
        another process     RunFolderBusy, before anything is removed; the folder is this process's until
        `release` or its writes there        end (output/files/lock.py)
        """
        if restart and overwrite:
            raise ValueError(
                "restart and overwrite exclude each other: restart keeps the files that overwrite removes"
            )
        if restart:
            found = cls.latest(case_name, results) if out is None else cls.open(out)
            lock.take(found.path)
            found.tidy()
            return found
        if out is None:
            found = cls(_make_next(case_name, Path(results)))
            lock.take(found.path)
            return found
        path = Path(out)
        try:
            path.mkdir(parents=True)
        except FileExistsError:
            if not overwrite or not path.is_dir():
                raise _exists(path) from None
            lock.take(path)
            cls(path).clear()
        lock.take(path)
        return cls(path)

    @classmethod
    def open(cls, path: str | os.PathLike) -> RunFolder:
        """An existing run folder; RunFolderMissing when there is none."""
        if not Path(path).is_dir():
            raise RunFolderMissing(f"run folder {path} does not exist")
        return cls(Path(path))

    def read_summary(self) -> dict[str, Any]:
        """Contents of summary.json, empty without one; raises CaseError if it is damaged."""
        return read_summary(self.summary) if self.summary.is_file() else {}

    def write_case(self, case: Case) -> None:
        """Write case.yaml; and case.resolved.yaml if the case has figures from catalogue, defaults or formulas."""
        case.dump(self.case)
        if case.figures.of_item:
            self.resolved_case.write_text(case.to_sourced_yaml(), encoding="utf-8")

    @classmethod
    def latest(cls, case_name: str, results: str | os.PathLike = "results") -> RunFolder:
        """The folder with the highest number of this case; RunFolderMissing when there is none."""
        numbers = _numbers(case_name, Path(results))
        if not numbers:
            raise RunFolderMissing(f"no run folder {Path(results) / case_name}-NNN exists")
        return cls(numbers[max(numbers)])

    def release(self) -> None:
        """Let other processes write here, after this process has finished writing. Without effect in a process that
        does not hold the folder."""
        lock.release(self.path)

    def tidy(self) -> None:
        """Remove half-written files that a killed run left."""
        remove_leftovers(self.path)
        remove_leftovers(self.string_frames)
        remove_leftovers(self.sensors)

    def clear(self) -> None:
        """Remove the files of the contract, and nothing else in the folder."""
        from drillpetsc.output.catalogue import tables

        self.tidy()
        for file in (
            self.string_series,
            self.well,
            self.summary,
            self.checkpoint,
            self.case,
            self.resolved_case,
            self.report,
            *(
                self.path / name
                for name in (*tables(), ROADMAP_FILE, FOLLOW_TABLE, FOLLOW_STATE, FOLLOW_PAGE)
            ),
        ):
            file.unlink(missing_ok=True)
        for frame in self.string_frames.glob("*.vtu"):
            frame.unlink()
        for file in (*self.sensors.glob("*.csv"), *self.sensors.glob("*.h5")):
            file.unlink()
        for name in PARAVIEW_FILES:  # of the frames that are gone
            (self.paraview / name).unlink(missing_ok=True)
        for name in PARAVIEW_GRIDS:
            for frame in (self.paraview / name).glob("*.vtp"):
                frame.unlink()
        for folder in (self.sensors, *(self.paraview / name for name in PARAVIEW_GRIDS), self.paraview):
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()
        if self.string_frames.is_dir() and not any(self.string_frames.iterdir()):
            shutil.rmtree(self.string_frames)


def _numbers(case_name: str, results: Path) -> dict[int, Path]:
    """Existing numbered folders of a case: number -> path."""
    pattern = re.compile(re.escape(case_name) + r"-(\d{3,})")
    found = {}
    if results.is_dir():
        for entry in results.iterdir():
            match = pattern.fullmatch(entry.name)
            if match:
                found[int(match.group(1))] = entry
    return found


def _make_next(case_name: str, results: Path) -> Path:
    if not case_name or "/" in case_name or case_name in (".", ".."):
        raise ValueError(f"a case name that makes no folder name: {case_name!r}")
    results.mkdir(parents=True, exist_ok=True)
    number = max(_numbers(case_name, results), default=0) + 1
    while True:
        path = results / f"{case_name}-{number:03d}"
        try:
            path.mkdir()
            return path
        except FileExistsError:
            number += 1


def _exists(path: Path) -> RunFolderExists:
    """The error that a folder cannot be new."""
    if not path.is_dir():
        return RunFolderExists(f"output folder {path} exists and is not a folder: give another --out")
    return RunFolderExists(
        f"output folder {path} exists: give another --out, or --restart to continue it, or --overwrite to replace it"
    )


def refuse_existing(comm: Any, out: str | os.PathLike) -> None:
    """Raise CaseError on every rank if a new folder ``out`` cannot be made, before a long computation; collective."""

    def refuse() -> None:
        if (path := Path(out)).exists():
            raise CaseError(at="--out", got=str(out), want=str(_exists(path)))

    first_rank_gives(comm.tompi4py(), refuse)


def make_folder(
    comm: Any, name: str, out: str | os.PathLike | None, restart: bool, overwrite: bool
) -> RunFolder:
    """Make the folder of a run on rank 0 (``RunFolder.create``); collective.

    Raises CaseError on every rank if that fails.
    """

    def made() -> RunFolder:
        try:
            return RunFolder.create(name, out, restart=restart, overwrite=overwrite)
        except OSError as error:
            raise CaseError(at="--out", got=str(out) if out else "", want=str(error)) from None

    found: RunFolder = first_rank_gives(comm.tompi4py(), made)
    return found
