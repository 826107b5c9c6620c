"""Numbers and ranges of options, the options of hydraulics and surge, and the pressure window of a case."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc import Case
from drillpetsc.analysis.hydraulics.surge import Trips
from drillpetsc.case.files.named_file import FOLDER
from drillpetsc.case.options.ranges import read_numbers
from drillpetsc.case.quantities import Quantity
from drillpetsc.errors import CaseError
from drillpetsc.operations import Hydraulics
from tests.helpers.tables import each_row
from tests.helpers.trips import trips_of

FLOW = Quantity("m^3/s", above=0, at_most=1)
GPM = 231 * 0.0254**3 / 60  # [m3/s]


@each_row(
    ("text", "values"),
    [
        ("400,500,600 gpm", (400 * GPM, 500 * GPM, 600 * GPM)), ("30 l/s, 500 gpm", (0.03, 500 * GPM)),
        ("20, 30 l/s, 400 gpm", (0.02, 0.03, 400 * GPM)), ("0.02", (0.02,)), (0.02, (0.02,)),
        ([0.02, "30 l/s"], (0.02, 0.03)), ("1e-2", (0.01,)),
    ],
)  # fmt: skip
def test_numbers(text, values):
    assert read_numbers(text, FLOW, "--flow", "400 gpm") == pytest.approx(values, rel=1e-9)


def test_a_range_with_a_step():
    """Both ends, in any unit, beside other numbers; as for rotary speeds."""
    assert read_numbers("10:40:10 l/s", FLOW, "--flow", "") == pytest.approx((0.01, 0.02, 0.03, 0.04))
    assert read_numbers("10:35:10,50 l/s", FLOW, "--flow", "") == pytest.approx((0.01, 0.02, 0.03, 0.05))
    for text, words in (
        ("10:40:50 l/s", "a step above 0, not larger"),
        ("10:40:-1 l/s", "above 0"),
        ("0.1:900:0.1 l/s", "at most 2000 values"),
        ("40:10:1 l/s", "smaller to a larger"),
        ("10::1 l/s", "one number, then its unit"),
    ):
        with pytest.raises(CaseError, match=words):
            read_numbers(text, FLOW, "--flow", "")


def test_a_range_has_ten_values():
    values = read_numbers("20..200 l/s", FLOW, "--flow", "")
    assert values == pytest.approx([0.02 * k for k in range(1, 11)])
    assert read_numbers("20 l/s..0.2 m3/s", FLOW, "--flow", "") == pytest.approx(values)


@each_row(
    ("text", "words"),
    [
        ("400", "bare number is in m\\^3/s"), ("0 gpm", "above 0"), ("-3 gpm", "above 0"),
        ("", "numbers with commas"), ("400,,500 gpm", "numbers with commas"), ("much", "number comes first"),
        ("3 psi", "pressure"), ("60..20 l/s", "smaller to a larger"), ("nan l/s", "flow rate"),
        ("1e999 l/s", "finite"),
    ],
)  # fmt: skip
def test_flows_that_are_refused(text, words):
    with pytest.raises(CaseError, match=words):
        Hydraulics(case=None, flow=text).read("SI")


def test_trips():
    assert trips_of(speeds="0.5 m/s") == Trips((0.5,))
    trips = trips_of(
        speeds="30 ft/min",
        operation="trip_out",
        pipe="open,pumping,open",
        bit_depth="1000 m",
        window="9,12 ppg",
        flow="400 gpm",
    )
    assert trips.operations == ("trip_out",) and trips.pipes == ("open", "pumping")
    assert trips.flow == pytest.approx(400 * GPM) and trips.bit_depths == (1000.0,)
    assert trips.window is not None and trips.window.pore[0] == pytest.approx(9 * 119.8264, rel=1e-6)


@each_row(
    ("options", "words"),
    [
        ({"operation": "pull"}, "trip_in, trip_out"), ({"pipe": "opn"}, "did you mean 'open'"),
        ({"window": "12,9 ppg"}, "frac above pore"), ({"window": "12 ppg"}, "two densities"),
        ({"window": "9,12,13 ppg"}, "two densities"), ({"flow": "400 gpm"}, "--pipe pumping"),
        ({"pipe": "pumping", "flow": "400,500 gpm"}, "one number"), ({"bit_depth": "-4 m"}, "above 0"),
    ],
)  # fmt: skip
def test_trips_that_are_refused(options, words):
    with pytest.raises(CaseError, match=words):
        trips_of(speeds="30 ft/min", **options)


def test_flow_and_pressure_exclude_each_other():
    with pytest.raises(CaseError, match="not both"):
        Hydraulics(case=None, flow="400 gpm", spp="3000 psi").read("SI").compute(None)
    assert Hydraulics(case=None, spp="10 bar").read("SI").spp == 1e6


# ---------------------------------------------------------------------- window
WELL = {
    "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"kind": "open_hole", "diameter": 0.2}],
}
BASE = {"string": [{"kind": "pipe", "length": 100, "od": 0.127, "id": 0.1}], "top": "clamped", "well": WELL}


def test_one_pair_and_a_table():
    pair = Case(**BASE, window={"pore": "1.1 g/cm3", "frac": 1500}).window
    assert pair.tvd is None and pair.pore == (1100.0,) and pair.frac == (1500.0,)
    table = Case(**BASE, window={"tvd": ["0 m", "1 km"], "pore": [1000, 1200], "frac": [1500, 1600]})
    assert table.window.tvd == (0.0, 1000.0)
    assert "window:" in table.to_yaml() and "window" not in Case(**BASE).to_yaml()


def test_a_window_from_a_file(tmp_path: Path):
    (tmp_path / "w.csv").write_text(
        "# from the mud plan\nformation, TVD [ft], pore [ppg], frac [ppg]\nshale,0,9,12\n\nsand,5000,10,14\n"
    )
    token = FOLDER.set(tmp_path)
    try:
        window = Case(**BASE, window="w.csv").window
    finally:
        FOLDER.reset(token)
    assert window.tvd == pytest.approx((0.0, 1524.0))
    assert window.frac == pytest.approx((12 * 119.8264, 14 * 119.8264), rel=1e-6)


@each_row(
    ("text", "words"),
    [
        ("", "a header such as"), ("tvd, pore\n0,1\n", "frac"), ("tvd,pore,frac,pore\n0,1,2,3\n", "once"),
        ("tvd [psi],pore,frac\n0,1,2\n", "length"), ("tvd,pore,frac [kg/m3]\n0,1000,x\n", "a number in kg"),
        ("tvd,pore,frac\n0,1000\n", "empty cell"), ("tvd,pore,frac\n0,1000,1200\n", "two depths"),
        ("tvd,pore,frac\n0,1000,1200\n0,1000,1200\n", "rising depths"),
        ("tvd,pore,frac\n0,1000,1200\n9,1000,900\n", "above pore"),
    ],
)  # fmt: skip
def test_window_files_that_are_refused(text, words, tmp_path: Path):
    (tmp_path / "w.csv").write_text(text)
    with pytest.raises(CaseError, match=words):
        Case(**BASE, window=str(tmp_path / "w.csv"))


@each_row(
    ("window", "words"),
    [
        ({"pore": 1200, "frac": 1100}, "above pore"),
        ({"pore": [1000, 1100], "frac": 1200}, "one value without tvd"),
        ({"tvd": [0, 10], "pore": [1000], "frac": [1200, 1300]}, "2 values"),
        ({"pore": -1, "frac": 1100}, "above 0"),
        ({"pore": 1000}, "frac"),
        ("no-such.csv", "that exists"),
    ],
)
def test_windows_that_are_refused(window, words):
    with pytest.raises(CaseError, match=words):
        Case(**BASE, window=window)
