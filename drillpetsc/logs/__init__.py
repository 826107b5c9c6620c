"""Logs of a rig as they were recorded: read, checked, divided into rig states, and condensed to points for `calibrate`."""
