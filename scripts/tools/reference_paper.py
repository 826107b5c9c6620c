"""Both studies of the reference paper (DOI 10.1177/1687814016656703; manual: sec-paper-studies).

first: a vertical well of 2000 m with mud and without, and with single terms of the mud switched; pictures of weight on bit, bit speed,
orbits, shape and radius.  knobs: the same whirl, turning from the start, with numerical parameters changed.  settings: the first study
and two of its other assemblies at the default settings and at converged ones.  second: build rates of three assemblies over density and
flow rate of the mud.  Each writes a table, the studies their pictures.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.motion.transient import run
from drillpetsc.case import load_case
from drillpetsc.output import read_frame, read_series, read_table

ROOT = Path(__file__).parents[2]
CASE, STUDY = ROOT / "cases" / "vertical-2000m.yaml", ROOT / "cases" / "reference-paper"
FRAMES = ["output.field_every=1 s", "output.item_forces=true"]
ITEMS = {1998.75: "near-bit", 1999.75: "bit"}  # middles [m] of the rigid items
#: name -> (changes, description)
FIRST: dict[str, tuple[list[str], str]] = {
    "mud": ([], "all terms"),
    "dry": (["fluid=off"], "no mud"),
    "no-swirl": (["fluid.swirl=none"], "mud that does not swirl"),
    "half-swirl": (["fluid.swirl=0.2"], "half the swirl about the collars"),
    "thin-gap-swirl": (["fluid.swirl=0.48"], "1.2 times the swirl about the collars"),
    "no-added-mass": (["fluid.added_mass=none"], "without added mass"),
    "no-damping": (["fluid.lateral_damping=none"], "without viscous damping of lateral motion"),
    "pump-off": (["fluid.flow_rate=0 l/s"], "pump off"),
    "quaternion": (["beam.formulation=quaternion"], "with the reference paper's element"),
}
IMPACTS = ["output.history_every=1 ms"]  # an impact of the near-bit stabilizer lasts 8 ms
TURNING = ["top.rotation=80 rpm"]  # steady from the start
KNOBS: dict[str, tuple[list[str], str]] = {
    "default": ([], "as the case has it"),
    "soft-rock": (["formation.young=2 GPa"], "modulus of the rock x 0.1"),
    "hard-rock": (["formation.young=200 GPa"], "modulus of the rock x 10"),
    "restitution": (["contact.restitution=0.2"], "restitution 0.2 for 0.5"),
    "slip": (["contact.slip_velocity=0.003 m/s"], "slip velocity x 0.3"),
    "fine-mesh": (
        ["string[0].element_length=5.03 m", "string[1].element_length=4 m", "string[2].element_length=0.5 m"],
        "elements x 0.5",
    ),
    "tolerance": (["petsc.ts_rtol=1e-5"], "tolerance x 0.1"),
    "quaternion": (["beam.formulation=quaternion"], "the reference paper's element"),
    "bdf": (["petsc.ts_type=bdf", "petsc.ts_adapt_dt_max=2.3e-4"], "BDF 2, steps by the energy rule"),
}
COLLAR = "{kind: pipe, name: drill collar, length: 1.5 m, od: 177.8 mm, id: 71.4 mm, element_length: 1.5 m, eccentricity: 0.5 mm}"
STABILIZERS = {"near-bit": [], "slick": [f"string[3]={COLLAR}"], "full-gauge": ["string[3].od=215.9 mm"]}
FIXED = [
    "time.integrator=generalized_alpha",
    "petsc.ts_adapt_type=none",
    "petsc.ts_dt=2e-4",
    "petsc.ts_rtol=1e-6",
]
CONVERGED = {"default": [], "tolerance": ["petsc.ts_rtol=1e-6"], "fixed": FIXED}
#: assembly and settings -> (changes, description)
SETTINGS: dict[str, tuple[list[str], str]] = {
    f"{assembly}-{setting}": ([*changes, *more], f"{assembly}, {setting} steps")
    for assembly, changes in STABILIZERS.items()
    for setting, more in CONVERGED.items()
}
ASSEMBLIES = ("fulcrum", "pendulum", "slick")
DENSITIES, FLOWS = (1000, 1300, 1700), (20, 40)
PROBES = (600, 1200, 1900)
CLEARANCE = {600: (224.4 - 127) / 2, 1200: (215.9 - 127) / 2, 1900: (215.9 - 177.8) / 2}  # [mm]
OMEGA = 80 * np.pi / 30


def figures(folder: Path, summary: dict, after: float) -> dict[str, float]:
    """Figures of a run for the table: means from a time on, the bit speed of the first swings."""
    h, p = read_table(folder / "history.csv"), read_table(folder / "probes.csv")
    late, late_p = h["time [s]"] > after, p["time [s]"] > after
    speed = h["bit_speed [rad/s]"][h["time [s]"] < 6.0] / OMEGA
    out = {
        "torque [N m]": h["surface_torque [N m]"][late].mean(),
        "WOB [kN]": h["wob [N]"][late].mean() / 1e3,
        "std WOB [kN]": h["wob [N]"][late].std() / 1e3,
        "bit speed [rpm]": h["bit_speed [rad/s]"][late].mean() * 30 / np.pi,
        "bit speed from [-]": speed.min(),
        "to [-]": speed.max(),
    }
    for depth, item in ITEMS.items():
        force = h.get(f"side_force_{depth:.10g} [N]")
        if force is not None:
            out[f"side force {item} [N]"] = force[late].mean()
            out[f"its rms {item} [N]"] = np.sqrt((force[late] ** 2).mean())
    for depth in PROBES:
        z = 1e3 * (p[f"x_{depth} [m]"] + 1j * p[f"y_{depth} [m]"])
        out[f"radius {depth} m [mm]"] = np.abs(z)[late_p].max()
        turned = np.diff(np.unwrap(np.angle(z))[late_p][[0, -1]])[0] / np.ptp(p["time [s]"][late_p])
        out[f"whirl {depth} m [-]"] = turned / OMEGA
        contact = p.get(f"contact_{depth} [N]")
        if contact is not None:
            out[f"contact {depth} m [N]"] = np.sqrt((contact[late_p] ** 2).mean())
    cost = {"steps": summary["steps"], "CPU [s]": summary["cpu_seconds"]}
    return out | cost | {"energy error [%]": 100 * summary["energy"]["error_share"]}


def compute(name: str, file: Path, changes: list[str], out: Path) -> dict[str, Any]:
    """Run a case; returns its summary."""
    case = load_case(file, changes)
    return dict(run(case, out / name, overwrite=True, name=name, progress="silent").summary)


def write_table(rows: dict[str, dict[str, float]], file: Path) -> None:
    columns = list(dict.fromkeys(c for row in rows.values() for c in row))
    lines = [
        ["", *columns],
        *([n, *(f"{row[c]:.5g}" if c in row else "" for c in columns)] for n, row in rows.items()),
    ]
    file.write_text("\n".join(",".join(line) for line in lines) + "\n", encoding="utf-8")


def histories(folders: dict[str, Path], out: Path) -> None:
    """Draw weight on bit and bit speed over time, and the radius of the orbits (figures 8 and 9 of the paper)."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(3, 1, figsize=(9, 8), sharex=True, layout="constrained")
    for name, folder in folders.items():
        h, p = read_table(folder / "history.csv"), read_table(folder / "probes.csv")
        axes[0].plot(h["time [s]"], h["wob [N]"] / 1e3, label=name, lw=0.9)
        axes[1].plot(h["time [s]"], h["bit_speed [rad/s]"] * 30 / np.pi, label=name, lw=0.9)
        axes[2].plot(p["time [s]"], 1e3 * np.hypot(p["x_1900 [m]"], p["y_1900 [m]"]), label=name, lw=0.9)
    axes[0].set_ylabel("weight on bit [kN]")
    axes[1].set_ylabel("bit speed [rpm]")
    axes[2].set(ylabel="offset at 1900 m [mm]", xlabel="time [s]")
    axes[2].axhline(CLEARANCE[1900], color="#6b5b45", lw=1)
    axes[0].legend(frameon=False, ncols=len(folders))
    figure.savefig(out / "histories.png", dpi=110)
    plt.close(figure)


def orbits(folders: dict[str, Path], out: Path) -> None:
    """Draw shape at the end and paths of the string's centre at the probes (figures 10 and 11); on the circle the pipe touches the wall."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        len(folders), 4, figsize=(12, 3.1 * len(folders)), layout="constrained", squeeze=False
    )
    turn = np.linspace(0, 2 * np.pi, 200)
    for row, (name, folder) in zip(axes, folders.items(), strict=True):
        time, file = read_series(folder)[-1]
        data = read_frame(file).point_data
        for direction, label in (("x", "north"), ("y", "east")):
            row[0].plot(1e3 * data[f"offset_{direction} [m]"], data["md [m]"], lw=0.8, label=label)
        row[0].set(
            title=f"{name}, {time:.3g} s",
            xlabel="offset [mm]",
            ylabel="measured depth [m]",
            ylim=(2000, 1500),
        )
        row[0].legend(frameon=False)
        p = read_table(folder / "probes.csv")
        for axis, depth in zip(row[1:], PROBES, strict=True):
            axis.plot(CLEARANCE[depth] * np.cos(turn), CLEARANCE[depth] * np.sin(turn), color="#6b5b45", lw=1)
            axis.plot(1e3 * p[f"x_{depth} [m]"], 1e3 * p[f"y_{depth} [m]"], lw=0.5)
            axis.set(aspect="equal", title=f"{depth} m", xlabel="north [mm]", ylabel="east [mm]")
    figure.savefig(out / "orbits.png", dpi=110)
    plt.close(figure)


def variants(
    all_of: dict[str, tuple[list[str], str]],
    out: Path,
    names: list[str],
    end: float,
    common: Sequence[str] = (),
    mean: float = 1 / 3,
) -> dict[str, dict[str, float]]:
    """Run variants of the first study; returns their figures, with means over the last share ``mean`` of the time."""
    rows = {}
    for name in names or all_of:
        changes, words = all_of[name]
        summary = compute(name, CASE, [*FRAMES, f"time.end={end} s", *common, *changes], out)
        rows[name] = figures(out / name, summary, (1 - mean) * end)
        print(f"{name}: {words}\n  " + ", ".join(f"{k} {v:.5g}" for k, v in rows[name].items()), flush=True)
    return rows


def first(out: Path, names: list[str], end: float) -> None:
    """The first study, with its pictures of ``mud`` and ``dry``."""
    rows = variants(FIRST, out, names, end)
    write_table(rows, out / "first.csv")
    shown = {name: out / name for name in [n for n in ("mud", "dry") if n in rows] or rows}
    for draw in (histories, orbits):
        draw(shown, out)


def knobs(out: Path, names: list[str], end: float) -> None:
    """The whirl of the first study with numerical parameters changed; steady rotation from the start."""
    write_table(variants(KNOBS, out, names, end, TURNING), out / "knobs.csv")


def settings(out: Path, names: list[str], end: float) -> None:
    """The first study and its other assemblies at the default settings and at converged ones."""
    write_table(variants(SETTINGS, out, names, end, IMPACTS, 2 / 3), out / "settings.csv")


def second(out: Path, names: list[str], end: float) -> None:
    """The second study: build rates, and the picture of them over the density."""
    import matplotlib.pyplot as plt

    rows: dict[str, dict[str, float]] = {}
    for assembly in names or ASSEMBLIES:
        muds: list[tuple[int, int, list[str]]] = [(0, 0, ["fluid=off"])]
        muds += [
            (d, q, [f"fluid.density={d} kg/m3", f"fluid.flow_rate={q} l/s"]) for d in DENSITIES for q in FLOWS
        ]
        for density, flow, changes in muds:
            summary = compute(f"{assembly}-{density}-{flow}", STUDY / f"{assembly}.yaml", changes, out)
            hole, bit = summary["new_hole"], summary["rigid_items"][-1]
            row = {
                "density [kg/m3]": density,
                "flow [l/s]": flow,
                "build rate [deg/30m]": hole["build_rate [deg/30m]"],
            }
            row |= {k: v for k, v in bit.items() if k.startswith("side")}
            rows[f"{assembly} {density} {flow}"] = row
            print(f"{assembly}: " + ", ".join(f"{k} {v:.5g}" for k, v in row.items()), flush=True)
    write_table(rows, out / "second.csv")
    figure, axes = plt.subplots(
        1, len(names or ASSEMBLIES), figsize=(11, 3.4), layout="constrained", squeeze=False
    )
    for axis, assembly in zip(axes[0], names or ASSEMBLIES, strict=True):
        own = [row for key, row in rows.items() if key.startswith(assembly)]
        for flow, mark in zip(FLOWS, ("o-", "s--"), strict=True):
            chosen = [row for row in own if row["flow [l/s]"] == flow]
            axis.plot(
                [r["density [kg/m3]"] for r in chosen],
                [r["build rate [deg/30m]"] for r in chosen],
                mark,
                label=f"{flow} l/s",
            )
        axis.axhline(own[0]["build rate [deg/30m]"], color="#6b5b45", lw=1, label="no mud")
        axis.set(title=assembly, xlabel="density of the mud [kg/m3]", ylabel="build rate [deg/30 m]")
    axes[0, 0].legend(frameon=False)
    figure.savefig(out / "second.png", dpi=110)
    plt.close(figure)


STUDIES = {
    "first": (first, FIRST, 16.0),
    "knobs": (knobs, KNOBS, 12.0),
    "settings": (settings, SETTINGS, 12.0),
    "second": (second, ASSEMBLIES, 0.0),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument(
        "--out",
        type=Path,
        default=ROOT / "results" / "reference-paper",
        help="folder of the runs and pictures",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="some of the variants or assemblies; default: all"
    )
    given = parser.parse_args()
    study, known, end = STUDIES[given.study]
    unknown = set(given.names) - set(known)
    if unknown:
        parser.error(f"{given.study} has no {', '.join(sorted(unknown))}: there are {', '.join(known)}")
    given.out.mkdir(parents=True, exist_ok=True)
    study(given.out, given.names, end)
    print(f"tables and pictures are in {given.out}")


if __name__ == "__main__":
    main()
