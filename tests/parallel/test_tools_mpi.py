"""The whole string with its tools in mud on 1, 2 and 3 ranks."""

from __future__ import annotations

import pytest
import yaml

from drillpetsc.output import read_table
from tests.helpers.ranks import all_on_ranks, run_here
from tests.helpers.whole_string import whole_string
from tests.parallel.matrix import tools_agree


@pytest.mark.parallel
def test_a_whole_string_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """With one and with two of some tools. A few steps, before one is repeated: histories are equal to rounding; torque and angles of joints that carry none are rounding.

    The string goes on from the state of another run: its buckles have more than one place, and which of them a search of 170
    factorisations ends at is rounding.  Stops of 1e9 N/m let Newton's method shrink a step by 1e-10; whether it reaches 1e-12 is, too.
    """
    options, jobs = ("-ts_adapt_type", "none", "-ts_dt", "2e-4", "-q_snes_stol", "1e-10"), {}
    for name, two in (("one", False), ("two", True)):
        path, start = tmp_path / f"{name}.yaml", tmp_path / f"{name}-start"
        case = whole_string(two) | {
            "time": {"end": 6e-4},
            "output": {"history_every": 2e-4, "checkpoint_every": 2e-4},
        }
        path.write_text(yaml.safe_dump(case))
        run_here(path, start, options)
        path.write_text(yaml.safe_dump(case | {"initial": {"from": str(start)}}))
        jobs[name] = path, options
    for folders in all_on_ranks(jobs, tmp_path).values():
        tools_agree(folders, read_table(folders[0] / "history.csv"), 1e-6)
