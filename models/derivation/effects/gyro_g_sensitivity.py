"""Drift of the gyros under specific force along their own axes."""

from sympy import diag

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    g = errors("g_x g_y g_z")
    reading = w + diag(*g) * Signals.force
    return sensor_table(
        RATE,
        reading,
        g,
        name="gyro-g-sensitivity",
        components=["x", "y", "z"],
        unit="rad/s/(m/s^2)",
        description="drift of each gyro in proportion to the specific force along its axis",
        equation="d_omega_i = g_i f_i",
    )
