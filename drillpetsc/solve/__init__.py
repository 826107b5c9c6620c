"""Solvers: the condensed Newton of a time step, statics, dynamics."""
