"""Scale-factor errors of the gyros."""

from sympy import diag

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    s = errors("s_x s_y s_z")
    reading = w + diag(*s) * w
    return sensor_table(
        RATE,
        reading,
        s,
        name="gyro-scale",
        components=["x", "y", "z"],
        unit="1",
        description="scale-factor error of each gyro",
        equation="d_omega_i = s_i omega_i",
        equations="Eq. 22, 24-34",
    )
