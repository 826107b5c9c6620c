"""Derivatives of a run by numbers of its case, in the steps of the run."""
