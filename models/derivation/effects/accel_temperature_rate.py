"""Biases of the accelerometers while they warm up or cool down."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * Signals.temperature_rate
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-temperature-rate",
        components=["x", "y", "z"],
        unit="m/s/K",
        description="bias of each accelerometer in proportion to the rate of its temperature",
        equation="d_f_i = k_i dT_i/dt",
    )
