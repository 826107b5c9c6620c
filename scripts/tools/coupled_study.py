"""First study of the reference paper (DOI 10.1177/1687814016656703; manual: sec-paper-reproduce): a vertical well
of 2000 m with and without drilling fluid.

Runs cases/vertical-2000m.yaml, the dry case and variants without single terms of the mud. Writes a table, and
pictures of weight on bit and bit speed, of orbits at the probes and of the lateral offset along depth.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from drillpetsc.analysis.transient import run
from drillpetsc.case import load_case
from drillpetsc.output import read_frame, read_series, read_table

ROOT = Path(__file__).parents[2]
COUPLED, DRY = ROOT / "cases" / "vertical-2000m.yaml", ROOT / "cases" / "vertical-2000m-dry.yaml"
NO_DAMPING, NO_MASS = "fluid.lateral_damping=none", "fluid.added_mass=none"
#: name -> (case, changes, description)
VARIANTS: dict[str, tuple[Path, list[str], str]] = {
    "dry": (DRY, [], "no mud"),
    "coupled": (COUPLED, [], "all terms"),
    "no-lateral-damping": (COUPLED, [NO_DAMPING], "without viscous damping of lateral motion"),
    "no-added-mass": (COUPLED, [NO_MASS], "without added mass"),
    "plug": (
        COUPLED,
        [NO_DAMPING, "fluid.added_mass=paper_plug"],
        "added mass of the reference paper (manual: eq-mud-chi), no lateral damping",
    ),
    "neither": (COUPLED, [NO_DAMPING, NO_MASS], "pressure, weight, buoyancy and flow alone"),
    "neither-still": (
        COUPLED,
        [NO_DAMPING, NO_MASS, "fluid.flow_rate=0"],
        "pressure, weight and buoyancy alone, pump off",
    ),
}
PROBES = (600, 1200, 1900)


def results(folder: Path, summary: dict, end: float) -> dict[str, float]:
    """Results of a run for the table: means over its second half."""
    h, p = read_table(folder / "history.csv"), read_table(folder / "probes.csv")
    late, late_p = h["time [s]"] > end / 2, p["time [s]"] > end / 2
    weight, speed = h["wob [N]"][late] / 1e3, h["bit_speed [rad/s]"][late] * 30 / np.pi
    out = {
        "mean WOB [kN]": weight.mean(),
        "std WOB [kN]": weight.std(),
        "bit speed from [rpm]": speed.min(),
        "to [rpm]": speed.max(),
    }
    for depth in PROBES:
        out[f"orbit {depth} m [mm]"] = 1e3 * np.hypot(p[f"x_{depth} [m]"], p[f"y_{depth} [m]"])[late_p].max()
    cost = {"steps": summary["steps"], "real-time factor": summary["real_time_factor"]}
    return out | cost | {"energy error [%]": 100 * summary["energy"]["error_share"]}


def histories(folders: dict[str, Path], out: Path) -> None:
    """Draw weight on bit and bit speed over time."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
    for name, folder in folders.items():
        h = read_table(folder / "history.csv")
        axes[0].plot(h["time [s]"], h["wob [N]"] / 1e3, label=name, lw=0.9)
        axes[1].plot(h["time [s]"], h["bit_speed [rad/s]"] * 30 / np.pi, label=name, lw=0.9)
    axes[0].set_ylabel("weight on bit [kN]")
    axes[1].set(ylabel="bit speed [rpm]", xlabel="time [s]")
    axes[0].legend(frameon=False)
    figure.savefig(out / "histories.png", dpi=130)
    plt.close(figure)


def orbits(folders: dict[str, Path], out: Path) -> None:
    """Draw paths of the string's centre at the probes; on the circle the pipe touches the wall."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        len(folders), 3, figsize=(9, 3.1 * len(folders)), layout="constrained", squeeze=False
    )
    clearance = {600: (224.4 - 127) / 2, 1200: (215.9 - 127) / 2, 1900: (215.9 - 177.8) / 2}
    turn = np.linspace(0, 2 * np.pi, 200)
    for row, (name, folder) in zip(axes, folders.items(), strict=True):
        p = read_table(folder / "probes.csv")
        for axis, depth in zip(row, PROBES, strict=True):
            axis.plot(clearance[depth] * np.cos(turn), clearance[depth] * np.sin(turn), color="#6b5b45", lw=1)
            axis.plot(1e3 * p[f"x_{depth} [m]"], 1e3 * p[f"y_{depth} [m]"], lw=0.5)
            axis.set(aspect="equal", title=f"{name}, {depth} m", xlabel="north [mm]", ylabel="east [mm]")
    figure.savefig(out / "orbits.png", dpi=130)
    plt.close(figure)


def shapes(folders: dict[str, Path], out: Path) -> None:
    """Draw the offset from the hole's axis along depth in the last frame."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        1, len(folders), figsize=(3.2 * len(folders), 7), sharey=True, layout="constrained", squeeze=False
    )
    for axis, (name, folder) in zip(axes[0], folders.items(), strict=True):
        time, file = read_series(folder)[-1]
        data = read_frame(file).point_data
        for direction, label in (("x", "north"), ("y", "east")):
            axis.plot(1e3 * data[f"offset_{direction} [m]"], data["md [m]"], lw=0.8, label=label)
        axis.set(title=f"{name}, {time:.3g} s", xlabel="offset [mm]")
    axes[0, 0].invert_yaxis()
    axes[0, 0].set_ylabel("measured depth [m]")
    axes[0, 0].legend(frameon=False)
    figure.savefig(out / "shapes.png", dpi=130)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--end", type=float, default=20.0, help="simulated time [s]")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "results" / "coupled-study", help="folder of the runs and pictures"
    )
    parser.add_argument(
        "variants",
        nargs="*",
        metavar="VARIANT",
        help=f"some of {', '.join(VARIANTS)}; default: all",
    )
    given = parser.parse_args()
    unknown = set(given.variants) - set(VARIANTS)
    if unknown:
        parser.error(f"no variant {', '.join(sorted(unknown))}: there are {', '.join(VARIANTS)}")
    folders, rows = {}, {}
    for name in given.variants or VARIANTS:
        file, changes, words = VARIANTS[name]
        folders[name] = given.out / name
        print(f"{name}: {words}", flush=True)
        result = run(
            load_case(file, [*changes, f"time.end={given.end}"]),
            folders[name],
            overwrite=True,
            name=name,
            progress="silent",
        )
        rows[name] = results(folders[name], result.summary, given.end)
        print("  " + ", ".join(f"{k} {v:.4g}" for k, v in rows[name].items()), flush=True)
    columns = list(next(iter(rows.values())))
    table = [["", *columns], *([name, *(f"{rows[name][c]:.4g}" for c in columns)] for name in rows)]
    (given.out / "table.csv").write_text("\n".join(",".join(line) for line in table) + "\n", encoding="utf-8")
    for draw in (histories, orbits, shapes):
        draw(folders, given.out)
    print(f"table.csv, histories.png, orbits.png, shapes.png in {given.out}")


if __name__ == "__main__":
    main()
