"""Drift of the gyros with their temperature."""

from sympy import diag

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    k = errors("k_x k_y k_z")
    reading = w + diag(*k) * Signals.gyro_temperature
    return sensor_table(
        RATE,
        reading,
        k,
        name="gyro-temperature-bias",
        components=["x", "y", "z"],
        unit="rad/s/K",
        description="drift of each gyro in proportion to its temperature above the reference",
        equation="d_omega_i = k_i (T_gi - T_ref)",
    )
