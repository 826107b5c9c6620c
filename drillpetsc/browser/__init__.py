"""A local page in the browser: a run with its string in the hole, and the form of a case."""
