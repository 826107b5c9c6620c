"""Commands over rotary speeds on several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from drillpetsc.output import read_table
from tests.helpers import frequency_models as m
from tests.helpers import top_drive_models as t
from tests.helpers.mpi import run_mpi
from tests.helpers.wells import simple_well
from tests.verification.test_stokes_modes import span

SCRIPT = Path(__file__).with_name("run_command.py")
WELL = simple_well(40, 0.2159, (0.5, 0.7), kind="casing", friction=0.2)
MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.02}


def columns(folder: Path, file: str, names: tuple[str, ...]) -> list[np.ndarray]:
    table = read_table(folder / file)
    return [np.asarray(table[name], dtype=float) for name in names]


@pytest.mark.parallel
def test_response_on_1_2_and_3_ranks(tmp_path):
    """An eccentric string on the wall of a curved hole, in mud, under its unbalance and under a moving bit."""
    file = tmp_path / "case.yaml"
    string = [m.drill_pipe(30.0, 6, 1e-4, eccentricity=2e-3), m.collars(9.5, 3, 1e-4)]
    string.append(
        {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60, "unbalance": 0.05, "nozzle_area": 4e-4}
    )
    case = {
        "string": string,
        "well": WELL,
        "fluid": MUD,
        "top": {"kind": "top_drive", "rotation": 6.0},
        "bottom": "bit",
    }
    file.write_text(yaml.safe_dump(case | {"initial": {"wob": 2e4}}))
    names = (
        "lateral_amplitude [m]", "axial_amplitude [m]", "axial_force_amplitude [N]",
        "bending_moment_amplitude [N m]", "stress_amplitude [Pa]", "shear_stress_amplitude [Pa]",
        "mean_stress [Pa]",
    )  # fmt: skip
    for excite in (["unbalance"], ["bit", "--amplitude", "1 mm"]):
        results = []
        for n in (1, 2, 3) if excite == ["unbalance"] else (1, 3):
            folder = tmp_path / f"{excite[0]}-{n}"
            run_mpi(
                n,
                SCRIPT,
                [
                    "response", str(file), "--excite", *excite, "--speeds", "60,120 rpm", "--stress", "--out",
                    str(folder),
                ],
            )  # fmt: skip
            results.append(columns(folder, "response.csv", names))
        for other in results[1:]:
            for one, values in zip(results[0], other, strict=True):
                assert values == pytest.approx(one, rel=1e-5, abs=1e-6 * np.abs(one).max())


@pytest.mark.parallel
def test_campbell_on_1_and_2_ranks(tmp_path):
    """Branches of the turning disc."""
    file = tmp_path / "case.yaml"
    file.write_text(yaml.safe_dump(m.disc()))
    results = []
    for n in (1, 2):
        folder = tmp_path / str(n)
        words = ["campbell", str(file), "--speeds", "0:600:200 rpm", "--count", "4", "--lines", "1"]
        run_mpi(n, SCRIPT, [*words, "--out", str(folder)])
        found = columns(folder, "campbell.csv", ("rotary_speed [rpm]", "frequency [Hz]"))
        results.append(np.sort(np.array(found)[1].reshape(-1, 4), axis=0))
        critical = columns(folder, "critical.csv", ("critical_rotary_speed [rpm]",))[0]
        assert critical == pytest.approx([362.605, 376.346], rel=2e-3)
    for other in results[1:]:
        assert other == pytest.approx(results[0], rel=1e-7)


@pytest.mark.parallel
def test_stokes_modes_and_stability_on_1_and_3_ranks(tmp_path):
    """A span in viscous mud, whose modes are refined on one rank, and a stick-slip boundary found by all."""
    stick = t.on_bottom(t.STIFF, 10.0, elements=10) | {"loads": []}
    (tmp_path / "span.yaml").write_text(yaml.safe_dump(span(2e-2, 8)))
    (tmp_path / "stick.yaml").write_text(yaml.safe_dump(stick))
    results = []
    for n in (1, 3):
        out = [tmp_path / f"{name}-{n}" for name in ("modes", "map")]
        run_mpi(n, SCRIPT, ["modes", str(tmp_path / "span.yaml"), "--count", "2", "--out", str(out[0])])
        words = [
            "--speeds", "110:140:30 rpm", "--wob", "100 kN", "--count", "1", "--kind", "torsional", "--out",
            str(out[1]),
        ]  # fmt: skip
        run_mpi(n, SCRIPT, ["stability", str(tmp_path / "stick.yaml"), *words])
        found = columns(out[0], "modes.csv", ("frequency [Hz]", "damping_ratio [-]", "stokes_number [-]"))
        found += columns(out[1], "stability_boundary.csv", ("boundary_speed [rpm]",))
        results.append(np.concatenate(found))
    for other in results[1:]:
        assert other == pytest.approx(results[0], rel=1e-6)


@pytest.mark.parallel
def test_critical_map_on_1_2_and_3_ranks(tmp_path):
    """Critical speeds over the stiffness of the wall, of a body between two points of the wall, and their table of branches."""
    from tests.verification.test_critical_map import critical, shaft

    file = tmp_path / "shaft.yaml"
    file.write_text(yaml.safe_dump(shaft()))
    words = [
        "campbell", str(file), "--speeds", "10:150:35 rpm", "--count", "4", "--kind", "lateral", "--lines",
        "1",
    ]  # fmt: skip
    walls = np.array([1e6, 1e9])
    results = []
    for n in (1, 2, 3):
        folder = tmp_path / f"ranks-{n}"
        run_mpi(n, SCRIPT, [*words, "--stiffness", "1e6,1e9 Pa", "--out", str(folder)])
        results.append(
            columns(folder, "critical_map.csv", ("wall_stiffness [Pa]", "critical_rotary_speed [rpm]"))
        )
    stiffness, speeds = results[0]
    for wall, expected in zip(walls, critical(walls), strict=True):
        assert np.min(np.abs(speeds[stiffness == wall] / expected - 1)) < 5e-3
    for other in results[1:]:
        assert np.array_equal(other[0], stiffness)
        assert other[1] == pytest.approx(speeds, rel=1e-6)


@pytest.mark.parallel
def test_response_at_a_place_on_1_2_and_3_ranks(tmp_path):
    """A torque at an item in the middle of the string."""
    file = tmp_path / "case.yaml"
    string = [
        m.drill_pipe(300.0, 30, 1e-3),
        m.drill_pipe(200.0, 20, 1e-3, name="tool"),
        m.drill_pipe(500.0, 50, 1e-3),
    ]
    file.write_text(yaml.safe_dump(m.two_part_string() | {"string": string}))
    results = []
    for n in (1, 2, 3):
        folder = tmp_path / f"ranks-{n}"
        words = ["--excite", "tool", "--amplitude", "1 kN m", "--speeds", "40,75 rpm", "--out", str(folder)]
        run_mpi(n, SCRIPT, ["response", str(file), *words])
        results.append(columns(folder, "response.csv", ("twist_amplitude [rad]", "torque_amplitude [N m]")))
    assert results[0][0].max() > 0
    for other in results[1:]:
        for one, values in zip(results[0], other, strict=True):
            assert values == pytest.approx(one, rel=1e-7, abs=1e-9 * np.abs(one).max())
