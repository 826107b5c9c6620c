"""Drilling dynamics from series of numbers: filters, indices, whirl and spectra (manual: sec-vibration).

Functions of arrays; they know neither case files nor runs.  Only numpy is imported.
"""

from drillpetsc.vibration.filters import LowPass, butterworth
from drillpetsc.vibration.indices import (
    depth_of_cut,
    drilling_efficiency,
    exceedances,
    mechanical_specific_energy,
    root_mean_square,
    stick_slip_index,
    stuck_share,
    time_mean,
)
from drillpetsc.vibration.spectra import (
    Spectrogram,
    order_map,
    power_density,
    ridge,
    spectrogram,
    turned_angle,
)
from drillpetsc.vibration.whirl import CLASSES, Whirl, rolling_ratio, whirl

__all__ = [
    "CLASSES",
    "LowPass",
    "Spectrogram",
    "Whirl",
    "butterworth",
    "depth_of_cut",
    "drilling_efficiency",
    "exceedances",
    "mechanical_specific_energy",
    "order_map",
    "power_density",
    "ridge",
    "rolling_ratio",
    "root_mean_square",
    "spectrogram",
    "stick_slip_index",
    "stuck_share",
    "time_mean",
    "turned_angle",
    "whirl",
]
