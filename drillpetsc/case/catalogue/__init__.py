"""Catalogue of tubulars: tables in CSV files, formulas of API RP 7G, text references such as `5in 19.50 S-135 NC50`.

The tables are in the units in which they are published (inch, lb/ft, lbf, ft-lbf). `drillpetsc.case.pipe.tubulars`
takes figures from here into the items of a case, in SI.
"""

from drillpetsc.case.catalogue.listing import CatalogueRows, catalogue
from drillpetsc.case.catalogue.reference import find_heavy_pipe, find_pipe
from drillpetsc.case.catalogue.tables import Catalogue, Row

__all__ = ["Catalogue", "CatalogueRows", "Row", "catalogue", "find_heavy_pipe", "find_pipe"]
