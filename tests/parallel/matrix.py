"""The parallel matrix: cases whose results must depend neither on the number of ranks nor on a restart.

A new tool adds one row to a file in `rows/`; `test_matrix.py` runs them.
"""

from tests.parallel.rows import ends, holes, machines, mud, strings

ROWS = holes.ROWS | machines.ROWS | ends.ROWS | mud.ROWS | strings.ROWS
