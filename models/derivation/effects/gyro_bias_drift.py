"""Drifts of the gyros that grow with time."""

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    k = errors("k_x k_y k_z")
    reading = w + Signals.time * k
    return sensor_table(
        RATE,
        reading,
        k,
        name="gyro-bias-drift",
        components=["x", "y", "z"],
        unit="rad/s^2",
        description="drift of each gyro growing with the time since the first sample",
        equation="d_omega_i = k_i t",
    )
