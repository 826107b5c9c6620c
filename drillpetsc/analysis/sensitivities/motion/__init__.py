"""Derivatives of runs in time."""
