"""Outputs: the quantities, their measurement during a run, and the files of a run folder.

This module re-exports the file formats of ``files/``: plain numpy arrays and dictionaries in, files out.  They do
not use PETSc, MPI or the case; rank 0 calls them with gathered arrays.
"""

from drillpetsc.output.files.fields import FieldWriter, read_series, write_well
from drillpetsc.output.files.json_file import read_summary, write_summary
from drillpetsc.output.files.lock import RunFolderBusy
from drillpetsc.output.files.run_folder import RunFolder, RunFolderExists, RunFolderMissing
from drillpetsc.output.files.tables import Table, read_table, write_rows, write_table
from drillpetsc.output.files.vtk import Frame, read_frame

__all__ = [
    "FieldWriter",
    "Frame",
    "RunFolder",
    "RunFolderBusy",
    "RunFolderExists",
    "RunFolderMissing",
    "Table",
    "read_frame",
    "read_series",
    "read_summary",
    "read_table",
    "write_rows",
    "write_summary",
    "write_table",
    "write_well",
]
