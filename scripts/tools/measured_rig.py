"""The laboratory rig of UFRJ: figures of its stick-slip and the parameters of cases/measured/ufrj-rig, from the public record.

Writes windows.csv of the case, and prints the fitted parameters. Both need the record (../shared/data, or DRILLPETSC_DATA), which is
not part of the project. The motion of the case, its figures and its picture do not.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from petsc4py import PETSc
from scipy.io import loadmat
from scipy.optimize import least_squares
from scipy.signal import butter, filtfilt, lfilter, medfilt

import drillpetsc
from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.calibration.log_series import LogSeries, scatter_of_rows
from drillpetsc.analysis.calibration.of_runs import RunCalibration, fit_run, run_of
from drillpetsc.analysis.calibration.words import lines_of_fit
from drillpetsc.output import read_table
from drillpetsc.parallel import initialise_petsc
from drillpetsc.plotting import style
from drillpetsc.units import to_si

ROOT = Path(__file__).parents[2]
CASE = ROOT / "cases" / "measured" / "ufrj-rig"
NAME = "ufrj-rig/175_completo_1.mat"
STEP = 1e-3  # of the record, and of the run [s]
LENGTH = 4.0  # of a window [s]
FITTED = 37.0  # start of the window that the authors calibrate on [s]
LOW_PASS = 10.0  # of the authors [Hz]
RPM = to_si("1 rpm", "rad/s")
STUCK = 10 * RPM  # a bit below this speed is stuck: twice the noise of the encoder at rest [rad/s]
STALLED = 0.3  # time at rest of a bit that stalls; it sticks for 0.06 s [s]
TURNING = 0.5  # the law of the torque is compared above this speed [rad/s]
SPIKES = 31  # samples of the median that takes the spikes off the top speed
#: of the case that the run itself is fitted with; the lag is the fitted one [s]; every such row of the record is read
RUN_PARAMETERS = (
    "string[1].inertia.axial",
    "string[0].torsional_stiffness",
    "formation.bit_law.static",
    "formation.bit_law.speed",
)
LAG, THINNED = 0.02, 5
PARAMETERS = {
    "bit inertia [kg m2]": 0.008,
    "shaft stiffness [N m/rad]": 4.0,
    "shaft damping [N m s/rad]": 0.02,
    "motor inertia [kg m2]": 1e-3,
    "motor time constant [s]": 0.02,
    "loss of speed [N m s/rad]": 0.3,
    "stall torque [N m]": 4.8,
    "static torque [N m]": 2.8,
    "dynamic torque [N m]": 0.1,
    "weakening speed [rad/s]": 19.0,
    "lag of the torque reading [s]": 0.03,
}  # with the values that the fit starts from


@dataclass(frozen=True)
class Record:
    """The record at 1 kHz, low-passed at 10 Hz. Arrays (n,): time [s], speeds [rad/s], torque on bit [N m], weight [N]."""

    time: np.ndarray
    bit: np.ndarray
    top: np.ndarray
    torque: np.ndarray
    weight: np.ndarray


@dataclass(frozen=True)
class Figures:
    """Stick-slip of a window: mean speed [rad/s], frequency [Hz], mean peak of the cycles [rad/s], share of the time stuck [-]."""

    mean: float
    frequency: float
    peak: float
    stuck: float


def path_of_record() -> Path:
    """Path of the record, whether or not it is at hand."""
    given = os.environ.get("DRILLPETSC_DATA")
    return (Path(given) if given else ROOT.parent / "shared" / "data") / NAME


def low_pass(signal: np.ndarray) -> np.ndarray:
    """Filter a signal (n,) at 1 kHz forward and backward (Butterworth, order 4), so that nothing is delayed."""
    return np.asarray(filtfilt(*butter(4, LOW_PASS * 2 * STEP), signal))


def read_record(path: Path) -> Record:
    """Read the record."""
    columns = {name.split("_Sample")[0]: np.ravel(value) for name, value in loadmat(path).items()}
    top = medfilt(columns["Top_Speed"], SPIKES)
    return Record(
        columns["Time"],
        low_pass(columns["Bit_Speed"]) * RPM,
        low_pass(top) * RPM,
        low_pass(columns["Bit_Torque"]),
        low_pass(columns["WOB"]),
    )


def figures(time: np.ndarray, speed: np.ndarray) -> Figures:
    """Compute the figures of a filtered bit speed (n,) [rad/s]; a cycle begins as the speed rises through its mean."""
    mean = speed.mean()
    k = np.flatnonzero((speed[:-1] < mean) & (speed[1:] >= mean))
    begin = time[k] + (mean - speed[k]) / (speed[k + 1] - speed[k]) * (time[k + 1] - time[k])
    peaks = [speed[a:b].max() for a, b in zip(k[:-1], k[1:], strict=True)]
    cycles = len(begin) - 1
    return Figures(
        float(mean),
        cycles / float(begin[-1] - begin[0]),
        float(np.mean(peaks)),
        float((speed < STUCK).mean()),
    )


def windows(record: Record) -> Iterator[tuple[float, float, Figures]]:
    """Start [s], mean weight [N] and figures of the windows of 4 s, counted from the fitted one, in which the bit never stalls."""
    for start in np.arange(FITTED % LENGTH, record.time[-1] - LENGTH, LENGTH):
        part = (record.time >= start) & (record.time < start + LENGTH)
        speed = record.bit[part]
        still = np.diff(np.flatnonzero(np.r_[True, speed >= STUCK, True])).max() * STEP
        if still < STALLED:
            yield float(start), float(record.weight[part].mean()), figures(record.time[part], speed)


def read_windows() -> dict[float, Figures]:
    """Figures of windows.csv by the start of the window [s]."""
    with (CASE / "windows.csv").open(newline="", encoding="utf-8") as lines:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]]
    return {
        start: Figures(mean * RPM, frequency, peak * RPM, stuck)
        for start, _, _, mean, frequency, peak, stuck in rows
    }


# ---------------------------------------------------------------------- the motion of the case
def computed(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Run the case. Time (n,) [s] and bit speed (n,) [rad/s] of its last 4 s, filtered as the record is."""
    drillpetsc.run(CASE / "case.yaml", out=folder, progress="silent")
    table = read_table(folder / "history.csv")
    time, speed = table["time [s]"], low_pass(table["bit_speed [rad/s]"])
    late = time >= time[-1] - LENGTH
    return time[late], speed[late]


def table_lines(found: Figures) -> list[str]:
    """Markdown table of the windows of the record, and of the computed motion."""

    def line(name: str, q: Figures) -> str:
        return (
            f"| {name} | {q.mean / RPM:.1f} | {q.frequency:.2f} | {q.peak / RPM:.0f} | {100 * q.stuck:.0f} |"
        )

    return [
        "| bit speed | mean [rpm] | frequency [Hz] | peak [rpm] | stuck [% of time] |",
        "| --- | --- | --- | --- | --- |",
        line("**computed**", found),
        *(
            line(f"{start:g} to {start + LENGTH:g} s" + (", fitted" if start == FITTED else ""), q)
            for start, q in read_windows().items()
        ),
    ]


def draw(time: np.ndarray, speed: np.ndarray, record: Record, path: Path) -> None:
    """Draw the computed bit speed over the measured one of the fitted window, both from a rise through the mean."""

    def from_rise(t: np.ndarray, q: np.ndarray) -> np.ndarray:
        rise = np.flatnonzero((q[:-1] < q.mean()) & (q[1:] >= q.mean()))[0]
        return np.asarray(t - t[rise])

    part = (record.time >= FITTED) & (record.time < FITTED + LENGTH)
    with style.look():
        drawing = style.figure(9.0, 3.4, dpi=110)
        axes = drawing.subplots()
        axes.plot(
            from_rise(record.time[part], record.bit[part]), record.bit[part] / RPM, "k", label="measured"
        )
        axes.plot(from_rise(time, speed), speed / RPM, color="#1f5fa8", label="computed")
        axes.set_xlim(0, 3.5)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("bit speed [rpm]")
        axes.legend(fontsize=8, loc="lower right", bbox_to_anchor=(1, 1), ncols=2)
        drawing.tight_layout()
        drawing.savefig(path)


# ---------------------------------------------------------------------- the fit
def _lagged(signal: np.ndarray, constant: float) -> np.ndarray:
    """First-order lag of a signal (n,) with a time constant [s]."""
    share = STEP / (constant + STEP)
    return np.asarray(lfilter([share], [1, share - 1], signal, zi=[signal[0] * (1 - share)])[0])


def fit(record: Record, start: float = FITTED) -> dict[str, float]:
    """Fit the parameters to three balances of torque [N m] in the window, by least squares.

    Drive: stall torque less loss of speed, after the motor's lag, accelerates the motor and twists the shaft. Bit: the shaft's torque
    accelerates the bit and overcomes the torque read. Law: the torque read is the torque of velocity_weakening at the speed read.
    The initial twist and its drift (the two encoders differ by 0.1 rad/s) are fitted with them. No figure of the motion enters.
    """
    time = record.time
    part = (time >= start) & (time < start + LENGTH)
    lead = int(0.5 / STEP)  # the lag of the motor starts earlier
    first = int(np.flatnonzero(part)[0])
    bit, top = record.bit[part], record.top[part]
    bit_rate, top_rate = (np.gradient(q, STEP)[part] for q in (record.bit, record.top))
    twist = np.cumsum(top - bit) * STEP
    twist -= twist.mean()
    centred, turning = time[part] - start - LENGTH / 2, bit > TURNING
    early = record.top[first - lead : first + len(top)]

    def residual(x: np.ndarray) -> np.ndarray:
        inertia, stiffness, damping, motor, lag, loss, stall, static, dynamic, speed, late, twisted, drift = x
        shaft = stiffness * twist + damping * (top - bit) + twisted + drift * centred
        drive = stall - loss * _lagged(early, lag)[lead:] - motor * top_rate - shaft
        read = np.interp(time[part] + late, time, record.torque)
        law = dynamic + (static - dynamic) * np.exp(-((bit / speed) ** 2))
        return np.concatenate([drive, shaft - inertia * bit_rate - read, (law - read)[turning]])

    begin = np.array([*PARAMETERS.values(), 2.1, -0.3])
    low, high = np.r_[np.zeros(11), -np.inf, -np.inf], np.full(13, np.inf)
    found = least_squares(residual, begin, bounds=(low, high), x_scale=np.abs(begin))
    return dict(zip(PARAMETERS, map(float, found.x), strict=False))


# ---------------------------------------------------------------------- the run itself, fitted to a short part
def fit_by_run(record: Record, begins: float = 1.0, length: float = 0.7) -> tuple[RunCalibration, Fit]:
    """Fit `RUN_PARAMETERS` to 0.7 s of bit speed, top speed and torque on bit by `calibrate --model dynamic`.

    The record begins in the middle of stick-slip.  Its first rise of the bit speed through the mean in the fitted window is put on the
    first such rise of the case's run after ``begins`` [s].
    """
    run = run_of(drillpetsc.load_case(CASE / "case.yaml"), PETSc.COMM_SELF)
    series = run_of(run.case, PETSc.COMM_SELF).series([], ["bit_speed"], end=begins + 1.0)
    late = series.times > begins
    part = (record.time >= FITTED) & (record.time < FITTED + LENGTH)
    there = _first_rise(series.times[late], series.values[late, 0])
    here = _first_rise(record.time[part], record.bit[part])
    rows = np.flatnonzero((record.time >= here) & (record.time < here + length))[::THINNED]
    torque = np.interp(record.time[rows] + LAG, record.time, record.torque)
    read = {"bit_speed": record.bit[rows], "top_speed": record.top[rows], "bit_torque": torque}
    log = LogSeries(
        path_of_record(),
        tuple(read),
        np.repeat(np.arange(len(read)), len(rows)),
        np.tile(record.time[rows] - here + there, len(read)),
        np.concatenate(list(read.values())),
        np.array([scatter_of_rows(values) for values in read.values()]),
        (),
    )
    work = RunCalibration(run, log)
    return work, fit_run(work, RUN_PARAMETERS, True, {})


def _first_rise(time: np.ndarray, speed: np.ndarray) -> float:
    """First time [s] at which the speed rises through its mean."""
    return float(time[np.flatnonzero((speed[:-1] < speed.mean()) & (speed[1:] >= speed.mean()))[0]])


def main() -> None:
    """Write windows.csv and print the fitted parameters."""
    initialise_petsc()
    record = read_record(path_of_record())
    with (CASE / "windows.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            ["from [s]", "to [s]", "weight [N]", "mean [rpm]", "frequency [Hz]", "peak [rpm]", "stuck [-]"]
        )
        for start, weight, found in windows(record):
            mean, peak = found.mean / RPM, found.peak / RPM
            table.writerow(
                [f"{start:g}", f"{start + LENGTH:g}", f"{weight:.0f}", f"{mean:.1f}"]
                + [f"{found.frequency:.3f}", f"{peak:.1f}", f"{found.stuck:.3f}"]
            )
    for name, value in fit(record).items():
        print(f"{name}: {value:.3g}")
    work, found = fit_by_run(record)
    print("by the run, 0.7 s:", *lines_of_fit(work, found), sep="\n")


if __name__ == "__main__":
    main()
