"""Drift of the gyros under specific force, along their own axes and across them."""

from sympy import Matrix

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table

AXES = "xyz"


def table():
    components = [i + j for i in AXES for j in AXES]
    g = errors(" ".join(f"g_{ij}" for ij in components))
    reading = Signals.rate + Matrix(3, 3, list(g)) * Signals.force
    return sensor_table(
        RATE,
        reading,
        g,
        name="gyro-g-sensitivity",
        components=components,
        unit="rad/s/(m/s^2)",
        description="drift of each gyro in proportion to the specific force; xy is what gyro x reads of the force along y",
        equation="d_omega_i = g_ix f_x + g_iy f_y + g_iz f_z",
    )
