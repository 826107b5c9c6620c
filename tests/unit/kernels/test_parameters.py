"""Names that C++ exports: columns, records, constants; tables filled by name."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.kernels.parameters import (
    Columns,
    Parameters,
    Table,
    columns,
    constant,
    parameters_of,
    structure,
)


def test_widths_follow_from_the_enum():
    names = columns("beam_parameters")
    assert names.names[:3] == ("length", "ea", "ei") and names.width == 19
    assert names["length"] == 0 and names["gravity"] == slice(9, 12) and names["rigid"] == 18


def test_twins_have_the_parameters_of_their_kernel():
    assert columns("quaternion_body_parameters").at == columns("body_parameters").at
    assert columns("beam_junction_damped_parameters").at == columns("beam_parameters").at


def test_extended_list_keeps_the_columns_of_the_short_one():
    short, long = columns("bit_flow_parameters"), columns("hermite_bit_parameters")
    assert all(long[name] == short[name] for name in short.names) and long.width == short.width + 9


def test_rows_are_set_and_read_by_name():
    p = Parameters("drive", 3, stiffness=2.0, damping=[0.1, 0.2, 0.3], inertia=1.0, angle=0.0, speed=0.0)
    assert p.array.flags.c_contiguous and p.array.shape == (3, 5)
    assert p["damping"] == pytest.approx([0.1, 0.2, 0.3])
    angle = p["angle"]
    angle[1] = 7.0
    assert p.array[1, 3] == 7.0
    p["stiffness"] *= 2.0
    assert (p.array[:, 0] == 4.0).all()


def test_vectors_are_spread_over_the_rows():
    names = Columns("test", {"a": 1, "v": 3})
    t = Table(names, 2, a=1.0, v=[1.0, 2.0, 3.0])
    assert (t["v"] == [[1.0, 2.0, 3.0]] * 2).all() and names.span("a", "v") == slice(0, 4)
    t["v"][:] = 0.0
    assert (t.array == [[1.0, 0.0, 0.0, 0.0]] * 2).all()
    t.update({"a": [5.0, 6.0]})
    assert (t.array[:, 0] == [5.0, 6.0]).all()


def test_name_left_out_or_unknown_is_an_error():
    with pytest.raises(TypeError, match="drive_parameters: not filled: angle, speed; unknown: torque"):
        Parameters("drive", 1, stiffness=1.0, damping=0.0, inertia=0.0, torque=1.0)
    with pytest.raises(KeyError, match="drive_parameters has no 'torque': it has stiffness, "):
        parameters_of("drive", np.zeros((1, 5)))["torque"]
    with pytest.raises(ValueError, match="5 columns"):
        parameters_of("drive", np.zeros((1, 6)))


def test_records_have_the_layout_of_the_struct():
    """structure() itself compares the size with C++'s."""
    fluid = structure("fluid")
    assert [name for name, _ in fluid._fields_] == [
        "density", "compressibility", "gravity", "clinging", "rheology",
    ]  # fmt: skip
    made = fluid(density=1.0, gravity=(0.0, 0.0, 9.8))
    assert tuple(made.gravity) == (0.0, 0.0, 9.8) and made.clinging == 0.0
    with pytest.raises(AttributeError):
        made.densty = 2.0
    for symbol in ("contact_law", "bit_law", "start_frames"):
        structure(symbol)


def test_results_of_a_record_may_be_vectors():
    names = columns("bit_rock_results")
    assert names["velocity"] == slice(8, 11) and names.width == 20


def test_constants_are_numbers():
    assert constant("contact_onset") == 1e-5 and constant("largest_block") == 32
