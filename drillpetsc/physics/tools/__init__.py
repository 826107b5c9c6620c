"""Downhole tools of the string, one file each."""
