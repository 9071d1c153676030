"""Biases of the accelerometers that change with temperature."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * Signals.temperature
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-temperature-bias",
        components=["x", "y", "z"],
        unit="m/s^2/K",
        description="bias of each accelerometer in proportion to its temperature above the reference",
        equation="d_f_i = k_i (T_i - T_ref)",
    )
