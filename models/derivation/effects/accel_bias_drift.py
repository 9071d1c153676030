"""Biases of the accelerometers that grow with time."""

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + Signals.time * k
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-bias-drift",
        components=["x", "y", "z"],
        unit="m/s^3",
        description="bias of each accelerometer growing with the time since the first sample",
        equation="d_f_i = k_i t",
    )
