"""Results of commands for Python and notebooks: tables with units, pictures, short reports.

Everything is read from the files of a run folder on first use. xarray, pandas and matplotlib are also imported then.
"""

from drillpetsc.results.result import Result, open_run

__all__ = ["Result", "open_run"]
