"""Tables over several variables as labelled arrays: a roadmap over operation, friction and bit depth, a stability map over weight and speed,
sensitivities over output and key.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

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

FACTORS = ("ff_cased", "ff_open_hole")


def roadmap_cube(table: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, from the rows of a roadmap.

    table: roadmap.csv by heading. Operations and friction pairs are in the order of the rows, bit depths ascend [m].
    A row that is not there gives nan, or an empty text.
    """
    columns = {split_name(heading)[0]: np.asarray(values) for heading, values in table.items()}
    pairs = zip(*(columns[name].astype(float).tolist() for name in FACTORS), strict=True)
    axes = {
        "operation": _in_order(columns["operation"].astype(str).tolist()),
        "friction": _in_order(map(str, pairs)),  # nan, for no cased or no open hole, differs from itself
        "bit_depth": np.unique(columns["bit_depth"].astype(float), return_inverse=True),
    }
    labels, at = ({name: axis[i] for name, axis in axes.items()} for i in (0, 1))
    return _labelled(labels, [(ROADMAP_TABLE, table, at)], dict.fromkeys(FACTORS, ("friction",)), title)


def stability_map(table: Table, runs: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, from the rows of a stability map.

    table: stability_map.csv by heading; runs: stability_runs.csv, which may be empty.
    Both axes ascend: weight_on_bit [N], rotary_speed [rpm]. A point that is not there gives nan, or an empty text.
    """
    axes = {"weight_on_bit": "weight_on_bit [N]", "rotary_speed": "rotary_speed [rpm]"}
    labels = {name: np.unique(table[heading].astype(float)) for name, heading in axes.items()}
    rows = [
        (file, given, {a: np.searchsorted(labels[a], given[axes[a]].astype(float)) for a in axes})
        for file, given in ((STABILITY_TABLE, table), (STABILITY_RUNS_TABLE, runs))
        if given
    ]
    return _labelled(labels, rows, {}, title)


#: columns of sensitivities.csv that belong to an output, and to a key
DIMENSIONS = dict.fromkeys(("output_unit", "value"), ("output",)) | dict.fromkeys(
    ("key_unit", "key_value", "per"), ("key",)
)


def sensitivity_table(table: Table, title: str = "") -> Columns:
    """A dataset of xarray, or `Columns` if xarray is not installed, with the dimensions output and key.

    table: sensitivities.csv by heading. An output of a roadmap at several bit depths is called `trip_out.hook_load at 1900 m`.
    """
    columns = {split_name(heading)[0]: np.asarray(values) for heading, values in table.items()}
    names, depths = columns["output"].astype(str).tolist(), columns["bit_depth"].astype(float)
    several = len(np.unique(depths[np.isfinite(depths)])) > 1
    words = [
        f"{n} at {d:.6g} m" if several and np.isfinite(d) else n for n, d in zip(names, depths, strict=True)
    ]
    axes = {"output": _in_order(words), "key": _in_order(columns["key"].astype(str).tolist())}
    labels, at = ({name: axis[i] for name, axis in axes.items()} for i in (0, 1))
    rows = {heading: values for heading, values in table.items() if split_name(heading)[0] != "bit_depth"}
    return _labelled(labels, [(SENSITIVITIES_TABLE, rows, at)], DIMENSIONS, title)


def _in_order(words: Iterable[str]) -> tuple[np.ndarray, np.ndarray]:
    """The different words in their order, and the number of the word of each row."""
    words = list(words)
    labels = list(dict.fromkeys(words))
    return np.array(labels), np.array([labels.index(word) for word in words], dtype=int)


def _labelled(
    labels: Mapping[str, np.ndarray],
    tables: Iterable[tuple[str, Table, Mapping[str, np.ndarray]]],
    over: Mapping[str, tuple[str, ...]],
    title: str,
) -> Columns:
    """The rows of tables at their places: nan or an empty text elsewhere.

    labels: along each dimension. tables: name of the file, columns by heading, dimension -> place of each row.
    over: dimensions of the columns that do not have all of them; these columns are coordinates.
    """
    arrays: dict[str, np.ndarray] = {}
    dims: dict[str, tuple[str, ...]] = {}
    described: dict[str, dict[str, str]] = {}
    for file, table, at in tables:
        for heading, column in table.items():
            name, values = split_name(heading)[0], np.asarray(column)
            numeric = values.dtype.kind in "fiu"
            if name in labels:
                arrays[name], dims[name] = labels[name], (name,)
            else:
                dims[name] = over.get(name, tuple(labels))
                shape = [len(labels[q]) for q in dims[name]]
                arrays[name] = np.full(shape, np.nan if numeric else "", dtype=float if numeric else object)
                arrays[name][tuple(at[q] for q in dims[name])] = values
            described[name] = attributes(heading, file, words=not numeric)
    return assembled(arrays, described, dims, {*labels, *over}, title)
