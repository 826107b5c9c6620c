"""Downhole sensors: their places in the string, samples and files (manual: sec-vibration-sensors)."""

from drillpetsc.output.sensors.sensors import Sensors

__all__ = ["Sensors"]
