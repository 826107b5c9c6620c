"""Reports and exports: results of run folders as one HTML file, or tables with units and headers as engineers write them.

Reads files and the plain data of a case, draws with ``drillpetsc.plotting``; solves nothing.
"""

from drillpetsc.reporting.export import export
from drillpetsc.reporting.report import report

__all__ = ["export", "report"]
