"""Tables of a run folder as datasets, arrays by name and frames."""

from __future__ import annotations

import copy
import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.output import FieldWriter, write_summary, write_table
from drillpetsc.output.catalogue import listed_by_file
from drillpetsc.results import open_run
from drillpetsc.results.datasets import Columns
from drillpetsc.results.described import attributes
from drillpetsc.units import to

TIME = [0.0, 0.5, 1.0]
POUND_FORCE = 4.4482216152605  # [N], NIST SP 811 (2008), appendix B


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A run folder written by hand."""
    columns = [("time", "s"), ("hook_load", "N"), ("bit_speed", "rad/s"), ("newton", "-")]
    hook_load = [1e3 * POUND_FORCE, 2e3 * POUND_FORCE, 0.0]
    write_table(tmp_path / "history.csv", columns, [TIME, hook_load, [0.0, np.pi, 1.0], [1, 2, 3]])
    write_table(tmp_path / "probes.csv", [("time", "s"), ("x_600", "m")], [TIME, [0.0, 0.0254, -0.0254]])
    trips = [("operation", "-"), ("surge_pressure", "Pa"), ("ecd_bit", "kg/m3"), ("trip_speed", "m/s")]
    write_table(tmp_path / "surge.csv", trips, [["trip_in"], [6894.757293168], [1198.264], [0.00508]])
    path = [("md", "m"), ("inclination", "deg"), ("azimuth", "deg"), ("dogleg_severity", "deg/30m")]
    path += [("north", "m"), ("east", "m"), ("tvd", "m")]
    numbers = [[0.0, 30.48], [0.0, 3.0], [0.0, 0.0], [0.0, 3.0], [0.0, 0.8], [0.0, 0.0], [0.0, 30.47]]
    write_table(tmp_path / "trajectory.csv", path, numbers)
    frames = FieldWriter(tmp_path)
    for time in TIME[:2]:
        points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0 + time]])
        fields = {
            "md [m]": np.array([0.0, 10.0]),
            "axial_force [N]": np.array([time, 0.0]),
            "velocity [m/s]": points,
        }
        frames.write(time, points, fields)
    write_summary(tmp_path / "summary.json", {"title": "By hand", "status": "done", "warnings": ["a < b"]})
    return tmp_path


@pytest.fixture
def no_extras(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("xarray", "pandas"):
        monkeypatch.setitem(sys.modules, name, None)


def test_arrays_by_name_without_xarray(folder: Path, no_extras: None) -> None:
    history = open_run(folder).history
    assert list(history) == ["time", "hook_load", "bit_speed", "newton"]
    assert history["hook_load"][1] == pytest.approx(2e3 * POUND_FORCE)
    assert history.attributes["hook_load"]["units"] == "N" and history.dims["hook_load"] == ("time",)
    assert "drillpetsc[notebook]" in repr(history)
    with pytest.raises(AttributeError, match=r"drillpetsc\[notebook\]"):
        history.sel(time=0.5)
    assert pickle.loads(pickle.dumps(history)).dims == history.dims
    string = open_run(folder).string
    assert string["axial_force"].shape == (2, 2) and string["md"].tolist() == [0.0, 10.0]
    assert string["position"][1, 1].tolist() == [0.0, 0.0, 10.5]
    assert string.dims["velocity"] == ("time", "md", "direction")


def test_no_frame_without_pandas(folder: Path, no_extras: None) -> None:
    with pytest.raises(CaseError) as error:
        open_run(folder).to_frame()
    assert "drillpetsc[notebook]" in error.value.want


def test_datasets_of_xarray(folder: Path) -> None:
    xarray = pytest.importorskip("xarray")
    result = open_run(folder)
    history = result.history
    assert isinstance(history, xarray.Dataset) and list(history.coords) == ["time"]
    assert float(history.hook_load.sel(time=0.5)) == pytest.approx(2e3 * POUND_FORCE)
    attrs = history.hook_load.attrs
    assert attrs["units"] == "N" and attrs["label"] and attrs["mnemonic"] and attrs["sign"]
    assert attrs["long_name"] == attrs["label"]
    in_klbf = to(history.hook_load, "klbf")
    assert in_klbf.values == pytest.approx([1.0, 2.0, 0.0]) and in_klbf.attrs["units"] == "klbf"
    assert result.probes.x_600.attrs["long_name"].count("600 m") == 1
    string = result.string
    assert string.axial_force.dims == ("time", "md") and string.velocity.dims == ("time", "md", "direction")
    assert float(string.position.sel(time=0.5, md=10.0, direction="down")) == 10.5
    trips = result.tables["surge"]
    assert trips.operation.dims == ("row",) and "units" not in trips.operation.attrs
    assert pickle.loads(pickle.dumps(result)).history.equals(history)


def test_a_change_of_a_dataset_does_not_reach_the_result(folder: Path) -> None:
    result = open_run(folder)
    result.history["hook_load"][:] = 0.0
    result.string["axial_force"][:] = 5.0
    assert float(result.history["hook_load"][1]) == pytest.approx(2e3 * POUND_FORCE)
    assert float(result.string["axial_force"][0, 0]) == 0.0


@pytest.mark.parametrize(
    ("table", "units", "heading", "wanted"),
    [
        (None, "field", "hook_load [klbf]", 1.0), (None, "metric", "hook_load [kN]", POUND_FORCE),
        (None, "metric_t", "hook_load [t]", POUND_FORCE / 9.80665),
        (None, None, "hook_load [N]", 1e3 * POUND_FORCE), ("surge", "field", "surge_pressure [psi]", 1.0),
        ("surge", "field", "ecd_bit [ppg]", 10.0), ("surge", "field", "trip_speed [ft/min]", 1.0),
        ("surge", "metric", "ecd_bit [sg]", 1.198264),
    ],
)  # fmt: skip
def test_frames_of_pandas_in_systems_of_units(
    folder: Path, table: str | None, units: str | None, heading: str, wanted: float
) -> None:
    pytest.importorskip("pandas")
    frame = open_run(folder).to_frame(table, units=units)
    assert float(frame[heading].iloc[0]) == pytest.approx(wanted, rel=1e-6)


def test_frames_have_the_coordinate_as_index_and_words_as_they_are(folder: Path) -> None:
    pytest.importorskip("pandas")
    result = open_run(folder)
    assert result.to_frame().index.name == "time [s]" and "newton" in result.to_frame()
    assert result.to_frame("surge")["operation"].tolist() == ["trip_in"]
    path = result.to_frame("trajectory", units="field")
    assert path.index.name == "md [ft]" and path.index[1] == pytest.approx(100.0)
    # 3 deg/30 m over 100 ft = 30.48 m
    assert path["dogleg_severity [deg/100ft]"].iloc[1] == pytest.approx(3.048)


def test_units_of_all_outputs_are_read_by_pint() -> None:
    """Except a consistency, whose unit has the flow index as an exponent, and residuals of hook loads and torques in
    one column.
    """
    pint = pytest.importorskip("pint")
    registry, failed = pint.UnitRegistry(), []
    for file, entries in listed_by_file().items():
        for entry in entries:
            unit = attributes(entry.quantity.title, file).get("units", "1")
            try:
                registry.parse_expression(unit)
            except Exception as error:  # pint raises many kinds
                failed.append(f"{unit}: {error}")
    assert {text.partition(":")[0] for text in failed} <= {"Pa s^n", "N or N m"}


def test_copies_hold_what_was_read(folder: Path, no_extras: None) -> None:
    result = open_run(folder)
    hook_load = result.history["hook_load"]
    again, other = pickle.loads(pickle.dumps(result)), copy.deepcopy(result)
    for file in folder.glob("*.csv"):
        file.unlink()
    assert np.array_equal(again.history["hook_load"], hook_load)
    assert np.array_equal(other.history["hook_load"], hook_load)
    with pytest.raises(CaseError, match=r"no probes\.csv"):
        _ = again.probes


def test_results_of_another_computation_are_refused(folder: Path, no_extras: None) -> None:
    result = open_run(folder)
    write_summary(folder / "summary.json", {"title": "Another"})
    for ask in (lambda: result.history, lambda: result.string, result.plot, result._repr_html_):
        with pytest.raises(CaseError, match="another computation"):
            ask()
    assert open_run(folder).history["hook_load"].size == 3


def test_a_folder_that_is_still_written_is_read_anew(folder: Path, no_extras: None) -> None:
    (folder / "summary.json").unlink()
    result = open_run(folder)
    assert result.status == "unfinished" and "has not ended" in str(result)
    with (folder / "history.csv").open("a") as file:
        assert result.history["time"].size == 3
        file.write("1.5,1,2,3\n")
    assert result.history["time"].size == 4


def test_the_report_of_a_result(folder: Path, no_extras: None) -> None:
    result = open_run(folder)
    assert result.kind == "run" and result.status == "done" and len(result.tables) == 4
    assert "a < b" in str(result) and "a &lt; b" in result._repr_html_()
    assert "<script" not in result._repr_html_() and "<svg" in result._repr_html_()
    assert len(repr(result)) < 500

    class Printer:
        text = ""

        def __init__(self) -> None:
            self.shown: list[str] = []
            self.text = self.shown.append

    printer = Printer()
    result._repr_pretty_(printer, False)
    assert printer.shown == [str(result)]


def test_pictures_by_name(folder: Path) -> None:
    result = open_run(folder)
    assert result.plot()._repr_png_().startswith(b"\x89PNG")
    shown = {text.get_text() for axes in result.plot(units="field").axes for text in [axes.yaxis.label]}
    assert any("klbf" in text for text in shown)
    assert result.plot("trajectory") is not None
    with pytest.raises(CaseError) as error:
        result.plot("histories")
    assert "history" in error.value.want
    with pytest.raises(CaseError):
        result.plot(units="imperial")


def test_wrong_tables_and_folders_are_refused(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    result = open_run(folder)
    with pytest.raises(KeyError, match="history, probes"):
        _ = result.tables["modes"]
    with pytest.raises(CaseError, match="history, probes"):
        _ = result.statics
    with pytest.raises(CaseError):
        open_run(folder / "nothing")
    with pytest.raises(CaseError):
        open_run(tmp_path_factory.mktemp("empty"))
    with pytest.raises(CaseError):
        result.to_frame("modes")


def test_columns_without_attributes_can_be_made() -> None:
    assert not Columns() and Columns().dims == {}


@pytest.mark.parametrize("kind", ["roadmap", "limits"])
def test_torque_and_drag_results(kind: str, tmp_path: Path, no_extras: None) -> None:
    first = "bit_depth" if kind == "roadmap" else "md"
    write_table(tmp_path / f"{kind}.csv", [(first, "m"), ("hook_load", "N")], [[10.0, 20.0], [1e3, 2e3]])
    write_summary(tmp_path / "summary.json", {"units": "metric"})
    result = open_run(tmp_path)
    assert result.kind == kind and list(result.tables) == [kind]
    assert result.tables[kind].dims[first] == ("row" if kind == "roadmap" else "md",)
    assert "hook_load [kN]" in str(result)
