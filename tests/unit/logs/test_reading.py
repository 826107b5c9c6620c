"""Logs out of files: names, units, nulls, clocks, and what is refused because it would be a guess."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import heading_of
from drillpetsc.logs.clock import ClockError, clock_times
from drillpetsc.logs.log import between, read_log, read_map

HEADINGS = [  # title, unit of the file, channel, unit
    ("hook load [t]", None, "hook_load", "t"),
    ("HKLD", "kkgf", "hook_load", "tf"),
    ("hookload_kN", None, "hook_load", "kN"),
    ("Hookload klbf", None, "hook_load", "klbf"),
    ("flow_in_lpm", None, "flow_rate", "lpm"),
    ("flow in [gpm]", None, "flow_rate", "gpm"),
    ("mud_density_in_g_per_cm3", None, "mud_density", "g/cm3"),
    ("rop_m_per_h", None, "rop", "m/h"),
    ("rop_ft_h", None, "rop", "ft/h"),
    ("rop_1ft_ft_per_h", None, "rop", "ft/h"),
    ("torque_downhole_kNm", None, "torque_downhole", "kN m"),
    ("TQA", "kft.lbf", "torque", "kft lbf"),
    ("bit_md_m", None, "bit_depth", "m"),
    ("time_utc", None, "time", ""),
    ("hookload_max_kN", None, "", ""),  # a largest value is not the hook load
    ("in_slips_s", None, "", ""),
    ("flow_out_percent", None, "", ""),
    ("gamma_gAPI", None, "", ""),
    ("hookload_expected_by_contractor_kN", None, "", ""),
]


def test_headings_name_channel_and_unit():
    wrong = []
    for title, unit, channel, expected in HEADINGS:
        found = heading_of(title, unit)
        if (found.channel, found.unit) != (channel, expected) or found.wrong:
            wrong.append((title, found))
    assert not wrong


def test_pressure_gauge_in_the_place_of_torque_is_named():
    found = heading_of("surface_torque_psi_of_gauge")
    assert found.channel == "torque" and found.wrong == "a pressure" and not found.unit


def _write(tmp_path, text, name="log.csv"):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_tonnes_and_kkgf_are_standard_weights(tmp_path):
    csv = _write(tmp_path, "md_m,hookload_t\n1000,100\n1001,-999.25\n")
    las = _write(
        tmp_path,
        "~V\nVERS. 3.0 :\nWRAP. NO :\nDLM. COMMA :\n~Well\nNULL. -1 :\n~Log_Definition\nDEPT .M : depth {F}\n"
        "HKLD .kkgf : hook load {F}\n~Log_Data | Log_Definition\n1000,100\n1001,-1\n",
        "three.las",
    )
    for path in (csv, las):
        log = read_log([path])
        np.testing.assert_allclose(log.values["hook_load"], [980665.0, np.nan])
        assert not log.by_time


def test_las_2_with_a_clock(tmp_path):
    text = "~V\nVERS. 2.0 :\nWRAP. NO :\n~W\nSTRT.S 0 :\nSTOP.S 0 :\nSTEP.S 0 :\nNULL. -999.25 :\n~C\nTIME. : time\n"
    text += "DBTM.F : bit\nHKLA.1000 lbf : hook load\n~A\n2020-01-01T00:00:00 1000 200\n2020-01-01T00:00:10 1001 -999.25\n"
    log = read_log([_write(tmp_path, text, "two.las")])
    np.testing.assert_allclose(log.values["time"], [0, 10])
    np.testing.assert_allclose(log.values["bit_depth"], [304.8, 305.1048])
    np.testing.assert_allclose(log.values["hook_load"], [200e3 * 4.4482216152605, np.nan])


WITSML = """<logs xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"><log uidWell="w" uid="l"><nameWell>A</nameWell>
<indexType>date time</indexType><nullValue>-99</nullValue>
<logCurveInfo uid="T"><mnemonic>TIME</mnemonic><unit>s</unit></logCurveInfo>
<logCurveInfo uid="B"><mnemonic>DBTM</mnemonic><unit>m</unit></logCurveInfo>
<logCurveInfo uid="H"><mnemonic>HKLA</mnemonic><unit>kN</unit></logCurveInfo>
%s</log></logs>"""
CHUNK = "<logData><mnemonicList>TIME,DBTM,HKLA</mnemonicList><unitList>s,m,kN</unitList>%s</logData>"


def test_witsml_chunks_are_joined(tmp_path):
    chunks = (
        CHUNK % "<data>2020-01-01T00:00:00Z,1000,900</data>"
        + CHUNK % "<data>2020-01-01T01:00:15+01:00,1001,-99</data>"
    )
    log = read_log([_write(tmp_path, WITSML % chunks, "log.xml")])
    np.testing.assert_allclose(log.values["time"], [0, 15])
    np.testing.assert_allclose(log.values["hook_load"], [900e3, np.nan])


def test_witsml_refusals(tmp_path):
    for old, new, words in (
        ('version="1.4.1.1"', 'version="2.0"', "1.4.1"),
        ("<data>2020-01-01T00:00:00Z,1000,900</data>", "<data>2020-01-01T00:00:00Z,1000</data>", "3 values"),
    ):
        text = (WITSML % (CHUNK % "<data>2020-01-01T00:00:00Z,1000,900</data>")).replace(old, new)
        with pytest.raises(CaseError, match=words):
            read_log([_write(tmp_path, text, "log.xml")])


def test_xlsx(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    from datetime import datetime

    book = openpyxl.Workbook()
    page = book.active
    for row in (
        ["A log of a rig"],
        ["Time", "Bit depth", "Hook load", "RPM"],
        [None, "ft", "klbf", "rpm"],
        [datetime(2020, 1, 1, 6), 3000, 250, 0],
        [datetime(2020, 1, 1, 6, 0, 5), 3001, 251, 60],
    ):
        page.append(row)
    book.save(tmp_path / "log.xlsx")
    log = read_log([tmp_path / "log.xlsx"])
    np.testing.assert_allclose(log.values["time"], [0, 5])
    np.testing.assert_allclose(log.values["bit_depth"], [914.4, 914.7048])
    np.testing.assert_allclose(log.values["rpm"], [0, 2 * np.pi])


REFUSED = [  # text, words of the message
    ("md_m,hookload\n1,2\n", "without a unit"),
    ("md_m,hookload_t,HKLD_kN\n1,2,3\n", "--map hook_load="),
    ("md_m,hookload_kg\n1,2\n", "mass"),
    ("md_m,hookload_t\n1,two\n", "line 2"),
    ("md_m,hookload_t\n1,1_0\n", "1_0"),
    ("md_m;hookload_t\n1;1,234\n", "may be 1234 or 1.234"),
    ("time,depth_m,hookload_t\n2020-01-01,1,2\n2020-01-02,2,2\n", "--map bit_depth="),
    ("time,bit_md_m,hookload_t\n01/02/2020 10:00,1,2\n", "told apart"),
    ("time,bit_md_m,hookload_t\n5,1,2\n", "time"),
    ("md_m,inc_deg,azi_deg\n1,2,3\n", "a heading with time or depth"),
    ("md_m,hookload_t\n1,2,3\n", "3 cells"),
    ("md_m,hookload_t\n", "no rows"),
]


def test_no_guess(tmp_path):
    wrong = []
    for text, words in REFUSED:
        try:
            read_log([_write(tmp_path, text)])
            wrong.append((text, "accepted"))
        except CaseError as error:
            if words not in " ".join(str(error).split()):
                wrong.append((text, str(error)))
    assert not wrong


def test_map_names_column_and_unit(tmp_path):
    path = _write(tmp_path, "md_m,HKLD,other\n1,2,3\n")
    log = read_log([path], read_map(["hook_load=other:t"]))
    np.testing.assert_allclose(log.values["hook_load"], 3 * 9806.65)
    assert log.mapped == {"hook_load"} and "HKLD" in log.unused
    for text in ("hook_load", "hook=HKLD", "hook_load=HKLD:bar", "hook_load="):
        with pytest.raises(CaseError, match="--map"):
            read_map([text])
    with pytest.raises(CaseError, match="one of md_m, HKLD, other"):
        read_log([path], read_map(["hook_load=none:t"]))


def test_decimal_comma_and_thousands(tmp_path):
    log = read_log([_write(tmp_path, "md_m;hookload_t\n1000,5;100,25\n1001,5;99,5\n")])
    np.testing.assert_allclose(log.values["bit_depth"], [1000.5, 1001.5])
    log = read_log([_write(tmp_path, 'md_m,hookload_t\n"1,000.5",100\n"1,001.5",101\n')])
    np.testing.assert_allclose(log.values["bit_depth"], [1000.5, 1001.5])


def test_reversed_time_and_equal_times(tmp_path):
    rows = [f"2020-01-01T00:00:{s:02d},{1000 + s},100" for s in (30, 20, 10)]
    log = read_log([_write(tmp_path, "\n".join(["time,bit_md_m,hookload_t", *rows]))])
    np.testing.assert_allclose(log.values["bit_depth"], [1010, 1020, 1030])
    assert "backwards" in log.remarks[0]
    log = read_log([_write(tmp_path, "\n".join(["time,bit_md_m,hookload_t", *rows[::-1], rows[0]]))])
    assert len(log) == 3 and "time of the row before" in log.remarks[0]


def test_clocks():
    seconds, start = clock_times(["31/12/2020 23:59:30", "01/01/2021 00:00:00"])
    assert seconds.tolist() == [0, 30] and start.isoformat() == "2020-12-31T23:59:30+00:00"
    seconds, _ = clock_times(["12/31/2020 11:59:30 PM", "01/01/2021 12:00:00 AM"])
    assert seconds.tolist() == [0, 30]
    _, start = clock_times(["01.03.2026 06:00:00"])
    assert start.isoformat() == "2026-03-01T06:00:00+00:00"
    _, start = clock_times(["12.11.2020 10:00", "12.31.2020 10:00"])
    assert start.isoformat() == "2020-12-11T10:00:00+00:00"
    for rows, words in (
        (["31/12/2020 10:00", "12/31/2020 10:00"], "the day first"),
        (["31.12.2020 10:00", "12.31.2020 10:00"], "the day first"),
        (["01/03/2026 10:00"], "no row has a number above 12"),
        (["06:00:00"], "--map date=TITLE"),
    ):
        with pytest.raises(ClockError, match=words):
            clock_times(rows)


def test_chunks_in_several_files_are_one_log(tmp_path):
    head = "time,bit_md_m,hookload_t\n"
    names = [
        _write(tmp_path, head + f"2020-01-01T00:00:{second},{1000 + second},100\n", f"{second}.csv")
        for second in (40, 10, 20)
    ]
    log = read_log(names)
    np.testing.assert_allclose(log.values["bit_depth"], [1010, 1020, 1040])
    with pytest.raises(CaseError, match="the columns of 40.csv"):
        read_log([names[0], _write(tmp_path, "time,bit_md_m,hookload_kN\n2020-01-01,1,2\n", "other.csv")])


def test_a_part_of_a_log(tmp_path):
    log = read_log([_write(tmp_path, "md_m,hookload_t\n" + "\n".join(f"{1000 + i},100" for i in range(9)))])
    np.testing.assert_allclose(between(log, "1002 m,1005 m").values["bit_depth"], [1002, 1003, 1004])
    for text in ("1 m", "1 kg,2 kg", "5000 m,6000 m"):
        with pytest.raises(CaseError, match="--between"):
            between(log, text)
