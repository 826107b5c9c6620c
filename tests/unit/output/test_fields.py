"""The .vtu and .pvd files: read back by meshio and pyvista, whole at any moment, continued at a restart."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.output import FieldWriter, read_frame, read_series, write_well
from drillpetsc.output.files.fields import cross_section_axes
from drillpetsc.output.files.tables import split_name
from tests.helpers.output_samples import HOLE, helix_frame, make_run


@pytest.fixture(scope="module")
def pyvista() -> Any:
    import pyvista  # takes longer to import than all of these tests

    return pyvista


@pytest.mark.parametrize("compress", [False, True])
def test_a_frame_reads_back_exactly(tmp_path: Path, compress: bool, pyvista: Any) -> None:
    import meshio  # a slow import

    points, data = helix_frame(0.3)
    cell = {"contact_force [N/m]": np.linspace(0, 1, len(points) - 1)}
    path = FieldWriter(tmp_path, compress=compress).write(0.3, points, data, cell)
    assert path == tmp_path / "string" / "000000.vtu"
    by_meshio, by_pyvista, by_us = meshio.read(path), pyvista.read(path), read_frame(path)
    assert np.array_equal(by_meshio.points, points) and np.array_equal(by_pyvista.points, points)
    plain = {title: split_name(title)[0] for title in data}
    assert set(by_meshio.point_data) == set(by_pyvista.point_data) == set(plain.values())
    assert set(by_us.point_data) == set(data)
    for title, values in data.items():
        assert np.array_equal(by_meshio.point_data[plain[title]], values)
        assert np.array_equal(by_pyvista.point_data[plain[title]], values)
        assert np.array_equal(by_us.point_data[title], values)
    assert np.array_equal(by_pyvista.cell_data["contact_force"], cell["contact_force [N/m]"])
    assert np.array_equal(by_us.cell_data["contact_force [N/m]"], cell["contact_force [N/m]"])


def test_units_are_metadata_that_vtk_reads(tmp_path: Path, pyvista: Any) -> None:
    from vtkmodules.vtkCommonCore import vtkDataArray

    points, data = helix_frame(0.3)
    read = pyvista.read(FieldWriter(tmp_path).write(0.3, points, {**data, "share [-]": data["spin [rad/s]"]}))
    units = {
        name: read.GetPointData().GetArray(name).GetInformation().Get(vtkDataArray.UNITS_LABEL())
        for name in read.point_data.keys()
    }
    assert units == {**{split_name(t)[0]: split_name(t)[1] for t in data}, "share": "-"}


def test_frames_of_before_whose_names_hold_the_unit_are_read(tmp_path: Path, pyvista: Any) -> None:
    points, data = helix_frame(0.3)
    line = pyvista.lines_from_points(points).cast_to_unstructured_grid()
    meshio = pytest.importorskip("meshio")
    old = meshio.Mesh(points, [("line", line.cells.reshape(-1, 3)[:, 1:])], point_data=dict(data))
    old.write(tmp_path / "old.vtu")
    read = read_frame(tmp_path / "old.vtu")
    assert set(read.point_data) == set(data) and np.array_equal(read.points, points)


@pytest.mark.parametrize("compress", [False, True])
def test_a_damaged_frame_is_named(tmp_path: Path, compress: bool) -> None:
    """Each cut of the file, and a byte changed anywhere in its data, is found or harmless: the shapes are right."""
    points, data = helix_frame(0.3, count=9)
    path = FieldWriter(tmp_path, compress=compress).write(0.3, points, data)
    whole, random = path.read_bytes(), np.random.default_rng(4)
    for cut in random.integers(0, len(whole) - 12, 60):
        path.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match=r"000000\.vtu is damaged"):
            read_frame(path)
    for at in random.integers(0, len(whole), 300):
        path.write_bytes(whole[:at] + bytes([random.integers(256)]) + whole[at + 1 :])
        try:
            read = read_frame(path)
        except ValueError as error:
            assert "000000.vtu is damaged" in str(error)
            continue
        assert read.points.shape == points.shape
        assert all(len(values) == len(points) for values in read.point_data.values())
    with pytest.raises(FileNotFoundError):
        read_frame(tmp_path / "none.vtu")


def test_the_string_is_a_chain_of_lines_in_order(tmp_path: Path, pyvista: Any) -> None:
    points, data = helix_frame(0.0, count=7)
    mesh = pyvista.read(FieldWriter(tmp_path).write(0.0, points, data))
    assert mesh.n_cells == 6 and set(mesh.celltypes) == {pyvista.CellType.LINE}
    assert mesh.cells.reshape(6, 3).tolist() == [[2, k, k + 1] for k in range(6)]


def test_one_element_is_enough_and_less_is_refused(tmp_path: Path, pyvista: Any) -> None:
    fields = FieldWriter(tmp_path)
    assert pyvista.read(fields.write(0.0, np.array([[0, 0, 0], [0, 0, 9.0]]), {})).n_cells == 1
    with pytest.raises(ValueError, match="n >= 2"):
        fields.write(1.0, np.zeros((1, 3)), {})
    with pytest.raises(ValueError, match=r"torque \[N m\].*wanted \(2,\)"):
        fields.write(1.0, np.zeros((2, 3)), {"torque [N m]": np.zeros(3)})
    assert [time for time, _ in read_series(tmp_path)] == [0.0]


def test_absent_physics_leaves_no_array(tmp_path: Path, pyvista: Any) -> None:
    run = make_run(tmp_path / "run", frames=1, well=False)
    names = pyvista.read(run.string_frames / "000000.vtu").array_names
    assert not [name for name in names if "contact" in name or "hole" in name or "offset" in name]


def test_the_series_is_whole_after_every_frame(tmp_path: Path, pyvista: Any) -> None:
    fields = FieldWriter(tmp_path)
    ElementTree.parse(tmp_path / "string.pvd")  # a run that was killed before its first frame
    for k in range(5):
        fields.write(0.1 * k, *helix_frame(0.1 * k))
        reader = pyvista.get_reader(tmp_path / "string.pvd")
        assert reader.time_values == [0.1 * j for j in range(k + 1)]
        reader.set_active_time_value(0.1 * k)
        assert np.array_equal(reader.read()[0].points, helix_frame(0.1 * k)[0])
    assert sorted(file.name for file in tmp_path.rglob("*")) == sorted(
        ["string", "string.pvd"] + [f"{k:06d}.vtu" for k in range(5)]
    )


def test_a_failing_write_leaves_series_and_frames_as_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fields = FieldWriter(tmp_path)
    fields.write(0.0, *helix_frame(0.0))
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}

    def half(path: Path, *_: object, **__: object) -> None:
        path.write_bytes(b"<VTKFile half")
        raise OSError("disk full")

    monkeypatch.setattr("drillpetsc.output.files.fields.write_vtu", half)
    with pytest.raises(OSError, match="disk full"):
        fields.write(1.0, *helix_frame(1.0))
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == before
    monkeypatch.undo()
    assert fields.write(1.0, *helix_frame(1.0)).name == "000001.vtu"


def test_restart_removes_later_frames_and_counts_on(tmp_path: Path) -> None:
    fields = FieldWriter(tmp_path)
    for k in range(6):
        fields.write(0.1 * k, *helix_frame(0.1 * k))
    (tmp_path / "string" / "000006.vtu").write_text("written, but the kill came before the series knew")
    again = FieldWriter(tmp_path, restart_time=0.1 * 3)
    assert sorted(file.name for file in (tmp_path / "string").iterdir()) == [f"{k:06d}.vtu" for k in range(4)]
    assert again.write(0.35, *helix_frame(9.0)).name == "000004.vtu"
    assert [time for time, _ in read_series(tmp_path)] == [0.0, 0.1, 0.2, 0.1 * 3, 0.35]


def test_a_fresh_writer_does_not_keep_another_runs_frames(tmp_path: Path) -> None:
    FieldWriter(tmp_path).write(0.0, *helix_frame(0.0))
    FieldWriter(tmp_path)
    assert read_series(tmp_path) == [] and list((tmp_path / "string").iterdir()) == []


def quarter_bend(count: int) -> tuple[np.ndarray, np.ndarray]:
    """md (n,), center (n, 3) [m] of a hole that turns from vertical to horizontal on a radius of 300 m."""
    angle = np.linspace(0, np.pi / 2, count)
    return 300 * angle, 300 * np.column_stack((1 - np.cos(angle), 0 * angle, np.sin(angle)))


def test_the_wall_is_a_closed_tube_around_the_axis(tmp_path: Path, pyvista: Any) -> None:
    """Every point lies a radius from its station, square to the axis (the arc's exact tangents, which the
    means of chords at inner stations of an evenly divided arc are by symmetry); area: the polygon's girth
    times arc length."""
    count, sides = 61, 24
    md, center = quarter_bend(count)
    mesh = pyvista.read(
        write_well(tmp_path / "well.vtu", md, center, np.full(count, 0.11), np.full(count, 0.3), sides=sides)
    )
    assert mesh.n_cells == (count - 1) * sides and set(mesh.celltypes) == {pyvista.CellType.QUAD}
    arms = mesh.points.reshape(count, sides, 3) - center[:, None, :]
    assert np.allclose(np.linalg.norm(arms, axis=2), 0.11, rtol=1e-10)
    tangent = np.column_stack((np.sin(md / 300), 0 * md, np.cos(md / 300)))
    along = np.einsum("ijk,ik->ij", arms, tangent)
    assert np.abs(along[1:-1]).max() < 1e-10
    assert mesh.area == pytest.approx(2 * sides * np.sin(np.pi / sides) * 0.11 * md[-1], rel=1e-3)
    assert np.array_equal(mesh["md"], np.repeat(md, sides))
    assert set(mesh.array_names) == {"md", "radius", "friction"}


def test_the_wall_does_not_twist_in_a_plane_bend(tmp_path: Path, pyvista: Any) -> None:
    """A frame that turns as little as possible keeps the plane's normal fixed: here east stays east."""
    md, center = quarter_bend(40)
    mesh = pyvista.read(write_well(tmp_path / "well.vtu", md, center, np.full(40, 0.1), sides=4))
    east = mesh.points.reshape(40, 4, 3)[:, :, 1]
    assert np.abs(east - east[0]).max() < 1e-12


def test_a_step_of_the_radius_is_a_station_given_twice(tmp_path: Path, pyvista: Any) -> None:
    md = np.array([0.0, 800.0, 800.0, 2000.0])
    center = np.column_stack((0 * md, 0 * md, md))
    mesh = pyvista.read(write_well(tmp_path / "well.vtu", md, center, np.array([0.12, 0.12, 0.1, 0.1])))
    away = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    assert np.allclose(away[mesh.points[:, 2] < 700], 0.12) and np.allclose(
        away[mesh.points[:, 2] > 900], 0.1
    )
    assert set(np.round(away[mesh.points[:, 2] == 800.0], 12)) == {0.12, 0.1}


def test_a_well_without_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no length"):
        write_well(tmp_path / "well.vtu", np.zeros(3), np.zeros((3, 3)), np.full(3, HOLE))
    assert list(tmp_path.iterdir()) == []


def test_the_cross_section_turns_as_little_as_possible_on_a_space_curve() -> None:
    """On a helix (a cos t, a sin t, c t) a frame without twist turns against the normal (-cos t, -sin t, 0)
    by the integral of the torsion, tau = c / (a^2 + c^2) (do Carmo 1976, section 1-5), over s = t sqrt(a^2 +
    c^2)."""
    a, c = 200.0, 150.0
    t = np.linspace(0, 3.0, 1201)
    center = np.column_stack((a * np.cos(t), a * np.sin(t), c * t))
    first, second = cross_section_axes(center)
    assert np.allclose(np.sum(first * second, axis=1), 0, atol=1e-12)
    assert np.allclose(np.linalg.norm(first, axis=1), 1) and np.allclose(np.linalg.norm(second, axis=1), 1)
    tangent = np.cross(first, second)
    exact = np.column_stack((-a * np.sin(t), a * np.cos(t), c + 0 * t)) / np.hypot(a, c)
    assert np.abs(tangent - exact)[1:-1].max() < 1e-5
    normal = np.column_stack((-np.cos(t), -np.sin(t), 0 * t))
    binormal = np.cross(exact, normal)
    turned = np.unwrap(np.arctan2(np.sum(first * binormal, axis=1), np.sum(first * normal, axis=1)))
    torsion = c / (a**2 + c**2)
    assert np.allclose(turned[1:-1] - turned[1], -torsion * np.hypot(a, c) * (t[1:-1] - t[1]), atol=1e-3)
