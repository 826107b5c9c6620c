"""Reports and exports: results of run folders as one HTML file, or in the units and words of people.

Reads files and the plain data of a case, draws with ``drillpetsc.plotting``; solves nothing.
"""

from drillpetsc.reporting.export import export
from drillpetsc.reporting.report import report

__all__ = ["export", "report"]
