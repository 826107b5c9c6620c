"""Results of commands for Python and notebooks: tables with units, pictures, short reports.

Everything is read from the files of a run folder, when it is asked for. xarray, pandas and matplotlib are imported then, too.
"""

from drillpetsc.results.result import Result, open_run

__all__ = ["Result", "open_run"]
