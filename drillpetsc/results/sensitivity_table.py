"""Sensitivities as labelled arrays: output x key."""

from __future__ import annotations

import numpy as np

from drillpetsc.output.files.run_folder import SENSITIVITIES_TABLE
from drillpetsc.output.files.tables import split_name
from drillpetsc.results.datasets import Columns, Table, assembled
from drillpetsc.results.described import attributes

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
            values = columns[name][1]
            numeric = values.dtype.kind in "fiu"
            arrays[name] = np.full(shape, np.nan) if numeric else np.full(shape, "", dtype=object)
            arrays[name][at] = values
            dims[name] = own
    described = {
        name: attributes(columns[name][0], SENSITIVITIES_TABLE, words=arrays[name].dtype.kind not in "fiu")
        for name in arrays
    }
    return assembled(arrays, described, dims, {"output", "key", *OF_OUTPUT, *OF_KEY}, title)
