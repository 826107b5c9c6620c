"""Downhole sensors: their places in the string, samples and files (manual: sec-vibration-sensors)."""
