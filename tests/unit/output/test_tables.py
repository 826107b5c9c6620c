"""Tables: headers, exact numbers, rows that survive a kill, restart."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drillpetsc.output import Table, read_table, write_table
from drillpetsc.output.files.tables import read_numbers, read_titles, rows_as_text, write_rows
from drillpetsc.output.quantities.tables import _condition, columns_of
from tests.helpers.tables import each_row

COLUMNS = [("time", "s"), ("hook_load", "N"), ("newton", "-")]


def test_header_has_names_and_units_of_what_is_there_only(tmp_path: Path) -> None:
    Table(tmp_path / "history.csv", COLUMNS).close()
    assert (tmp_path / "history.csv").read_text() == "time [s],hook_load [N],newton [-]\n"
    Table(tmp_path / "history.csv", COLUMNS[:2]).close()
    assert (tmp_path / "history.csv").read_text() == "time [s],hook_load [N]\n"


def test_rows_of_a_command_have_the_columns_that_every_file_has(tmp_path: Path) -> None:
    """A column with a condition may be absent; one without it that a row lacks is an error, and not a file without it."""
    whole = {q.name: 0.0 for q in columns_of("modes.csv", [])}
    assert "stokes_number" not in whole
    assert [q.name for q in columns_of("modes.csv", [whole | {"stokes_number": 1.0}])][-1] == "stokes_number"
    short = [{name: value for name, value in whole.items() if name != "frequency"}]
    with pytest.raises(KeyError, match="frequency"):
        write_rows(tmp_path / "modes.csv", columns_of("modes.csv", short), short)
    with pytest.raises(AttributeError):
        _condition("BORRE")


def test_two_columns_of_one_name_and_commas_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="two columns"):
        Table(tmp_path / "a.csv", [("time", "s"), ("x", "m"), ("x", "m")])
    with pytest.raises(ValueError, match="cannot hold"):
        Table(tmp_path / "a.csv", [("time", "s"), ("x,y", "m")])
    assert not (tmp_path / "a.csv").exists()


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=20))
def test_a_number_reads_back_as_the_same_double(
    tmp_path_factory: pytest.TempPathFactory, values: list[float]
) -> None:
    path = tmp_path_factory.mktemp("table") / "a.csv"
    with Table(path, [("time", "s"), ("x", "m")]) as table:
        for k, value in enumerate(values):
            table.add([k, value])
    back = read_table(path)["x [m]"]
    assert back.tobytes() == np.array(values).tobytes()


def test_numpy_rows_unknown_values_and_wrong_widths(tmp_path: Path) -> None:
    with Table(tmp_path / "a.csv", COLUMNS) as table:
        table.add(np.array([0.5, np.nan, 3]))
        table.add((np.float64(1.0), np.float32(2.0), np.int64(4)))
        with pytest.raises(ValueError, match="2 values for 3 columns"):
            table.add([1.0, 2.0])
    assert (tmp_path / "a.csv").read_text().splitlines()[1:] == ["0.5,nan,3", "1,2,4"]
    back = read_table(tmp_path / "a.csv")
    assert np.isnan(back["hook_load [N]"][0]) and back["newton [-]"].tolist() == [3.0, 4.0]


_FILLS_THE_DISK = """
import resource, signal, sys
import numpy as np
from drillpetsc.output import Table
table = Table(sys.argv[1], [("time", "s"), ("x", "m")])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
rows = np.column_stack([np.arange(100.0), np.arange(100.0) / 3])
try:
    table.add_rows(rows)
except OSError as error:
    print(error.filename)
"""


def test_of_many_rows_those_that_fit_on_the_disk_are_kept_whole(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    done = subprocess.run(
        [sys.executable, "-c", _FILLS_THE_DISK, str(path)], stdout=subprocess.PIPE, text=True, check=True
    )
    assert done.stdout.strip() == str(path)
    text = path.read_text()
    assert text.endswith("\n")
    assert 970 < len(text) <= 1000
    x = read_table(path)["x [m]"]
    assert np.array_equal(x, np.arange(len(x)) / 3)


def test_restart_drops_later_rows_and_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    times = [0.1 * k for k in range(11)]
    with Table(path, COLUMNS) as table:
        for t in times:
            table.add([t, 1.0, 2])
    with Table(path, COLUMNS, restart_time=times[6]) as table:
        table.add([0.65, 7.0, 3])
    back = read_table(path)
    assert back["time [s]"].tolist() == times[:7] + [0.65]
    assert back["hook_load [N]"].tolist() == [1.0] * 7 + [7.0]


@each_row("tail", ["0.3,1", "0.3,1.0,", "0.3,1,2"])
def test_an_incomplete_last_row_is_not_read_and_dropped_at_restart(tmp_path: Path, tail: str) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time [s],hook_load [N],newton [-]\n0.1,1,2\n0.2,1,2\n" + tail)
    assert read_table(path)["time [s]"].tolist() == [0.1, 0.2]
    with Table(path, COLUMNS, restart_time=5.0) as table:
        table.add([0.4, 1, 2])
    assert read_table(path)["time [s]"].tolist() == [0.1, 0.2, 0.4]


def test_restart_with_other_columns_is_refused_and_the_table_kept(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time [s],hook_load [N]\n0.1,1\n")
    with pytest.raises(ValueError, match="other columns.*hook_load.*newton"):
        Table(path, COLUMNS, restart_time=1.0)
    assert path.read_text() == "time [s],hook_load [N]\n0.1,1\n"


def test_restart_without_a_table_begins_one(tmp_path: Path) -> None:
    with Table(tmp_path / "probes.csv", COLUMNS, restart_time=3.0) as table:
        table.add([3.1, 1, 2])
    assert read_table(tmp_path / "probes.csv")["time [s]"].tolist() == [3.1]


def test_whole_tables_with_numbers_and_words(tmp_path: Path) -> None:
    path = tmp_path / "statics.csv"
    md, state = np.array([0.0, 10.0, 1e-300]), ["straight", "helical, then sinusoidal", "straight"]
    write_table(path, [("md", "m"), ("buckling", "-")], {"buckling": state, "md": md})
    back = read_table(path)
    assert list(back) == ["md [m]", "buckling [-]"]
    assert np.array_equal(back["md [m]"], md) and back["buckling [-]"].tolist() == state
    write_table(path, [("md", "m")], [[]])
    assert read_table(path)["md [m]"].shape == (0,)


def test_whole_tables_refuse_what_does_not_fit(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="one length"):
        write_table(tmp_path / "a.csv", [("a", "m"), ("b", "m")], [np.zeros(3), np.zeros(2)])
    with pytest.raises(ValueError, match="columns"):
        write_table(tmp_path / "a.csv", [("a", "m")], {"b": np.zeros(3)})
    assert list(tmp_path.iterdir()) == []


def test_rows_by_compiled_code_are_the_shortest_digits() -> None:
    """As Python's repr, which is checked by itself: any bits, decimals, whole numbers, and where the exponent begins."""
    random = np.random.default_rng(1)
    values = np.concatenate(
        [
            random.integers(0, 2**64, 20000, dtype=np.uint64).view(float),
            random.normal(size=20000) * 10.0 ** random.integers(-20, 20, 20000),
            random.integers(2**53, 10**16, 5000).astype(float),
            10.0 ** np.arange(-30, 30),
            [0.0, -0.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308, 1e16, 9999999999999998.0],
            [1e-4, 9.999999999999999e-5, -2.5, 123456789012345680.0, 2.0**53 + 2.0],
        ]
    )
    rows = values[: len(values) // 7 * 7].reshape(-1, 7)
    text = rows_as_text(rows).decode()
    words = [[repr(v).removesuffix(".0") for v in row] for row in rows.tolist()]
    assert text == "".join(",".join(row) + "\n" for row in words)
    assert rows_as_text(rows[:0]) == b""


def test_numbers_are_read_as_python_reads_them(tmp_path):
    """Rows of numbers have a reader of their own, which gives the same doubles, and leaves the same rows out."""
    rng = np.random.default_rng(3)
    values = rng.standard_normal((500, 3)) * 10.0 ** rng.integers(-300, 300, (500, 3))
    values[7] = np.nan, np.inf, -0.0
    path = tmp_path / "numbers.csv"
    rows = [",".join(map(repr, row)) for row in values.tolist()]
    for end, whole in (("\n", 500), ("", 499), ("\n1.5,2", 500), ("\n1.5,2\n", 500)):
        path.write_text("a [N],b [-],c [m]\n" + "\n".join(rows) + end)
        table = read_table(path)
        assert read_titles(path) == list(table) == ["a [N]", "b [-]", "c [m]"]
        for k, column in enumerate(table.values()):
            np.testing.assert_array_equal(column, values[:whole, k])
    path.write_text("a [N],b [-]\n")
    assert [len(column) for column in read_table(path).values()] == [0, 0]
    path.write_text("a [N],b [-]\n1,2\n3\n4,5\n")
    with pytest.raises(ValueError, match="a row has not 2 values"):
        read_table(path)
    path.write_text("a [N],b [-]\n1,2,3\n4,5,6\n")
    with pytest.raises(ValueError, match="a row has not 2 values"):
        read_table(path)


def test_a_word_under_a_unit_is_damage_and_words_have_no_unit(tmp_path: Path) -> None:
    file = tmp_path / "history.csv"
    file.write_text("time [s],hook_load [N],state [-]\n0,1,drilling\n1,2,drilling\n")
    assert list(read_table(file)["state [-]"]) == ["drilling", "drilling"]
    with pytest.raises(ValueError, match="state"):
        read_numbers(file)
    file.write_text("time [s],hook_load [N],newton [-]\n0,1,3\n1,junk,3\n")
    with pytest.raises(ValueError, match=r"history\.csv: hook_load \[N\].*junk"):
        read_table(file)
