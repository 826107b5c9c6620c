"""Tables over several variables as labelled arrays: a roadmap over operation, friction and bit depth, a stability map over weight and speed,
sensitivities over output and key.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillpetsc.output.files.run_folder import (
    ROADMAP_TABLE,
    SENSITIVITIES_TABLE,
    STABILITY_RUNS_TABLE,
    STABILITY_TABLE,
)
from drillpetsc.output.files.tables import split_name
from drillpetsc.results.datasets import Columns, Table, assembled
from drillpetsc.results.described import attributes

DIMENSIONS = ("operation", "friction", "bit_depth")
FACTORS = ("ff_cased", "ff_open_hole")


def roadmap_cube(table: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, from the rows of a roadmap.

    table: roadmap.csv by heading. Operations and friction pairs are in the order of the rows, bit depths ascend [m].
    A row that is not there gives nan, or an empty text.
    """
    columns = {split_name(heading)[0]: (heading, np.asarray(values)) for heading, values in table.items()}
    operation, depth = columns["operation"][1].astype(str), columns["bit_depth"][1].astype(float)
    pairs = list(zip(*(columns[name][1].astype(float).tolist() for name in FACTORS), strict=True))
    words = [str(pair) for pair in pairs]  # nan, for no cased or no open hole, differs from itself
    first = dict(zip(words, pairs, strict=True))
    operations, frictions = list(dict.fromkeys(operation.tolist())), list(dict.fromkeys(words))
    depths = np.unique(depth)
    at = (
        np.array([operations.index(word) for word in operation], dtype=int),
        np.array([frictions.index(word) for word in words], dtype=int),
        np.searchsorted(depths, depth),
    )
    shape = len(operations), len(frictions), len(depths)
    arrays = {"operation": np.array(operations), "bit_depth": depths}
    dims: dict[str, tuple[str, ...]] = {"operation": ("operation",), "bit_depth": ("bit_depth",)}
    for i, name in enumerate(FACTORS):
        arrays[name], dims[name] = np.array([first[word][i] for word in frictions]), ("friction",)
    for name in (q for q in columns if q not in arrays):
        arrays[name], dims[name] = _placed(columns[name][1], shape, at), DIMENSIONS
    described = {name: _attributes(columns[name][0], ROADMAP_TABLE, arrays[name]) for name in arrays}
    return assembled(arrays, described, dims, {"operation", "bit_depth", *FACTORS}, title)


def _placed(values: np.ndarray, shape: Sequence[int], at: tuple[np.ndarray, ...]) -> np.ndarray:
    """Values (n,) of rows at their places in an array; nan or an empty text elsewhere."""
    numeric = values.dtype.kind in "fiu"
    out = np.full(shape, np.nan if numeric else "", dtype=float if numeric else object)
    out[at] = values
    return out


def _attributes(heading: str, file: str, values: np.ndarray) -> dict[str, str]:
    return attributes(heading, file, words=values.dtype.kind not in "fiu")


def stability_map(table: Table, runs: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, from the rows of a stability map.

    table: stability_map.csv by heading; runs: stability_runs.csv, which may be empty.
    Both axes ascend: weight_on_bit [N], rotary_speed [rpm]. A point that is not there gives nan, or an empty text.
    """
    axes = {"weight_on_bit": "weight_on_bit [N]", "rotary_speed": "rotary_speed [rpm]"}
    values = {name: np.unique(table[heading].astype(float)) for name, heading in axes.items()}
    arrays: dict[str, np.ndarray] = dict(values)
    dims: dict[str, tuple[str, ...]] = {name: (name,) for name in axes}
    described = {name: attributes(heading, STABILITY_TABLE) for name, heading in axes.items()}
    for rows, file in ((table, STABILITY_TABLE), (runs, STABILITY_RUNS_TABLE)):
        for heading, column in rows.items():
            name = split_name(heading)[0]
            if name in axes:
                continue
            at = tuple(np.searchsorted(values[a], rows[axes[a]].astype(float)) for a in axes)
            arrays[name], dims[name] = _placed(column, [len(v) for v in values.values()], at), tuple(axes)
            described[name] = _attributes(heading, file, column)
    return assembled(arrays, described, dims, set(axes), title)


OF_OUTPUT = ("output_unit", "value")
OF_KEY = ("key_unit", "key_value", "per")
OF_BOTH = ("derivative", "relative", "effect", "effect_below", "effect_above", "flag")


def sensitivity_table(table: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, with the dimensions output and key.

    table: sensitivities.csv by heading. An output of a roadmap at several bit depths is called `trip_out.hook_load at 1900 m`.
    """
    columns = {split_name(heading)[0]: (heading, np.asarray(values)) for heading, values in table.items()}
    names, depths = columns["output"][1].astype(str), columns["bit_depth"][1].astype(float)
    several = len(np.unique(depths[np.isfinite(depths)])) > 1
    words = [
        f"{n} at {d:.6g} m" if several and np.isfinite(d) else n for n, d in zip(names, depths, strict=True)
    ]
    keys = columns["key"][1].astype(str)
    outputs, names_of_keys = list(dict.fromkeys(words)), list(dict.fromkeys(keys.tolist()))
    row = np.array([outputs.index(word) for word in words]), np.array([names_of_keys.index(k) for k in keys])
    arrays = {"output": np.array(outputs), "key": np.array(names_of_keys)}
    dims: dict[str, tuple[str, ...]] = {"output": ("output",), "key": ("key",)}
    for group, own, shape, at in (
        (OF_OUTPUT, ("output",), (len(outputs),), row[:1]),
        (OF_KEY, ("key",), (len(names_of_keys),), row[1:]),
        (OF_BOTH, ("output", "key"), (len(outputs), len(names_of_keys)), row),
    ):
        for name in group:
            arrays[name], dims[name] = _placed(columns[name][1], shape, at), own
    described = {name: _attributes(columns[name][0], SENSITIVITIES_TABLE, arrays[name]) for name in arrays}
    return assembled(arrays, described, dims, {"output", "key", *OF_OUTPUT, *OF_KEY}, title)
