"""Keys of summary.json that are not quantities of the model: counts, times, balances, settings.

`quantities/summaries.csv` has a row for each: the command, the path of the key, its unit, the name of its condition in
``conditions``, and its meaning.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from importlib.resources import files

from drillpetsc.output import conditions


@dataclass(frozen=True)
class SummaryKey:
    """One key of summary.json.

    name: path from the top, with dots; condition: what the case must contain for the key to exist; empty: always.
    """

    name: str
    unit: str
    doc: str
    condition: str


def _read() -> dict[str, tuple[SummaryKey, ...]]:
    keys: dict[str, tuple[SummaryKey, ...]] = {}
    text = files("drillpetsc.output.quantities").joinpath("summaries.csv").read_text(encoding="utf-8")
    for row in csv.DictReader(text.splitlines()):
        file, name = f"summary.json of {row['command']}", row["condition"]
        condition = getattr(conditions, name) if name else ""
        keys[file] = (*keys.get(file, ()), SummaryKey(row["name"], row["unit"], row["doc"], condition))
    return keys


#: keys by file, as the catalogue names the files
SUMMARY_KEYS = _read()
