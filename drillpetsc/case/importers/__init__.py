"""Readers of files from other programs: file -> plain data of the case's blocks, in SI."""
