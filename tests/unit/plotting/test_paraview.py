"""The scene for ParaView: curves, contact and mud on grids of their own, read back by VTK."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.output import FieldWriter, RunFolder, write_well
from drillpetsc.plotting.run.paraview import export_scene
from tests.helpers.output_samples import (
    AMPLITUDE,
    HOLE,
    LENGTH,
    PIPE,
    PITCH,
    helix_frame,
    make_pendulum,
    make_run,
)


@pytest.fixture(scope="module")
def pyvista() -> Any:
    import pyvista

    return pyvista


def helix_run(folder: Path, count: int) -> RunFolder:
    """A helix on the wall in two frames, with its slopes, contact and pressure."""
    run = make_run(folder, frames=0)
    fields = FieldWriter(run.path)
    for time in (0.0, 1.0):
        points, data = helix_frame(time, count)
        angle, turn = 2 * np.pi * data["md [m]"] / PITCH - time, 2 * np.pi / PITCH
        slope = np.column_stack(
            (-AMPLITUDE * turn * np.sin(angle), AMPLITUDE * turn * np.cos(angle), np.ones(count))
        )
        push = np.where(data["md [m]"] > 1000, 50.0, 0.0)
        more = {
            "slope [-]": slope,
            "contact_force [N/m]": push,
            "annulus_pressure [Pa]": 1e4 * data["md [m]"],
        }
        fields.write(time, points, {**data, **more})
    return run


def frames(pyvista: Any, folder: Path, name: str) -> list[Any]:
    """The grids of a series at its times."""
    reader = pyvista.get_reader(folder / f"{name}.pvd")
    found = []
    for time in reader.time_values:
        reader.set_active_time_value(time)
        found.append(reader.read()[0])
    return found


def test_the_curve_converges_to_the_helix_with_the_fourth_order(tmp_path: Path, pyvista: Any) -> None:
    """Distance of the points between nodes from the helix; a cubic with exact slopes is off by h^4/384 times the fourth derivative."""
    errors = []
    for count in (21, 41, 81):
        run = helix_run(tmp_path / str(count), count)
        export_scene(run.path, pieces=4, lateral_scale=1.0)
        curve = frames(pyvista, run.path / "paraview", "string")[0]
        assert curve.n_points == 4 * (count - 1) + 1 and curve.n_cells == curve.n_lines == 1
        angle = 2 * np.pi * curve.points[:, 2] / PITCH
        wanted = AMPLITUDE * np.column_stack((np.cos(angle), np.sin(angle)))
        errors.append(float(np.linalg.norm(curve.points[:, :2] - wanted, axis=1).max()))
        assert np.allclose(curve["md"], curve.points[:, 2])
    step = LENGTH / 80
    assert errors[2] < 1.5 * AMPLITUDE * (2 * np.pi / PITCH * step) ** 4 / 384
    assert np.log2(errors[0] / errors[1]) > 3.7 and np.log2(errors[1] / errors[2]) > 3.9


def test_lengths_across_the_hole_are_enlarged_about_its_centre(tmp_path: Path, pyvista: Any) -> None:
    run = helix_run(tmp_path / "run", 81)
    scene = export_scene(run.path, lateral_scale=50.0)
    curve = frames(pyvista, run.path / "paraview", "string")[1]
    assert np.allclose(np.hypot(*curve.points[::4, :2].T), 50 * AMPLITUDE) and scene.lateral_scale == 50
    assert np.allclose(curve["tube_radius"], 50 * PIPE) and np.allclose(curve["outer_radius"], PIPE)
    wall = pyvista.read(run.path / "paraview" / "well.vtu")
    assert np.allclose(np.hypot(*wall.points[:, :2].T), 50 * HOLE) and np.allclose(wall["radius"], HOLE)


def test_the_automatic_scale_shows_the_hole(tmp_path: Path) -> None:
    """The hole's radius of 0.1 m is drawn at about a fiftieth of the well's 2000 m."""
    assert export_scene(helix_run(tmp_path / "run", 21).path).lateral_scale == 400


def test_the_tube_filter_of_vtk_takes_the_radius_from_the_curve(tmp_path: Path, pyvista: Any) -> None:
    run = helix_run(tmp_path / "run", 81)
    export_scene(run.path, lateral_scale=100.0)
    curve = frames(pyvista, run.path / "paraview", "string")[0]
    tube = curve.tube(scalars="tube_radius", absolute=True, n_sides=24, capping=False)
    assert tube.area == pytest.approx(2 * np.pi * 100 * PIPE * curve.length, rel=0.02)


def test_contact_and_mud_have_grids_of_their_own(tmp_path: Path, pyvista: Any) -> None:
    run = helix_run(tmp_path / "run", 81)
    export_scene(run.path, lateral_scale=1.0)
    folder = run.path / "paraview"
    touching = frames(pyvista, folder, "contact")[0]
    assert touching.n_points == touching.n_verts == 40 and (touching["md"] > 1000).all()
    away = np.hypot(*touching.points[:, :2].T)
    assert np.allclose(away, AMPLITUDE + PIPE)  # on the outside of the pipe, towards the wall
    inward = -touching.points[:, :2] / away[:, None]
    assert np.allclose(touching["contact_vector"], 50 * np.column_stack((inward, np.zeros(40))), atol=1e-9)
    mud = frames(pyvista, folder, "mud")[0]
    assert np.allclose(mud.points[:, :2], 0, atol=1e-12) and np.allclose(mud["tube_radius"], HOLE)
    assert np.allclose(mud["annulus_pressure"], 1e4 * mud.points[:, 2])
    assert "annulus_pressure" not in frames(pyvista, folder, "string")[0].array_names


def test_a_curve_ends_at_a_joint(tmp_path: Path, pyvista: Any) -> None:
    """Two nodes at one depth: a tube has no direction between them."""
    run = RunFolder.create("joint", out=tmp_path / "run")
    md = np.array([0.0, 10.0, 20.0, 20.0, 30.0])
    data = {"md [m]": md, "axial_force [N]": md, "displacement [m]": np.zeros((5, 3))}
    FieldWriter(run.path).write(0.0, np.column_stack((0 * md, 0 * md, md)), data)
    export_scene(run.path, pieces=2)
    curve = frames(pyvista, run.path / "paraview", "string")[0]
    assert curve.n_cells == 2 and [cell.n_points for cell in curve.cell] == [5, 3]
    assert np.allclose(curve.points[:, 2], [0, 5, 10, 15, 20, 20, 25, 30])


def test_without_a_hole_there_is_the_string_alone_true_to_scale(tmp_path: Path, pyvista: Any) -> None:
    run = make_pendulum(tmp_path / "run")
    scene = export_scene(run.path)
    assert scene.lateral_scale == 1 and scene.frames == 3
    assert sorted(file.name for file in (run.path / "paraview").iterdir()) == [
        "scene.py",
        "string",
        "string.pvd",
    ]
    assert np.allclose(np.linalg.norm(frames(pyvista, run.path / "paraview", "string")[2].points[-1]), 0.5)


def test_the_scene_is_python_that_names_the_colour(tmp_path: Path) -> None:
    run = helix_run(tmp_path / "run", 21)
    text = export_scene(run.path, field="spin").script.read_text()
    compile(text, "scene.py", "exec")
    assert 'FIELD, UNIT = "spin", "rad/s"' in text and "$" not in text
    with pytest.raises(ValueError, match="no field 'spun' in this run; it has axial_force"):
        export_scene(run.path, field="spun")
    with pytest.raises(ValueError, match="positive"):
        export_scene(run.path, lateral_scale=-2.0)


def test_a_well_in_the_far_north_is_the_true_path(tmp_path: Path, pyvista: Any) -> None:
    """An axis that is not through the origin: enlarging moves no centre."""
    run = helix_run(tmp_path / "run", 21)
    md = np.linspace(0, LENGTH, 21)
    centre = np.column_stack((500 + 0.2 * md, 0 * md, md))
    write_well(run.well, md, centre, np.full(21, HOLE))
    export_scene(run.path, lateral_scale=10.0)
    wall = pyvista.read(run.path / "paraview" / "well.vtu")
    assert np.allclose(wall.points.reshape(21, 24, 3).mean(axis=1), centre)


def test_overwrite_removes_the_scene_of_the_run_before(tmp_path):
    """A shorter run in its place must not keep later frames of the old one; files of others in the folder stay."""
    run = helix_run(tmp_path / "run", 21)
    export_scene(run.path)
    assert (run.paraview / "scene.py").is_file() and list(run.paraview.glob("string/*.vtp"))
    RunFolder.create("helix", out=run.path, overwrite=True).release()
    assert not run.paraview.exists()
    run = helix_run(tmp_path / "other", 21)
    export_scene(run.path)
    (run.paraview / "mine.txt").write_text("kept")
    RunFolder.create("helix", out=run.path, overwrite=True).release()
    assert [file.name for file in run.paraview.iterdir()] == ["mine.txt"]
