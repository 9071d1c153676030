"""Cubic scale-factor errors of the accelerometers."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * f.applyfunc(lambda f_i: f_i**3)
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-cubic",
        components=["x", "y", "z"],
        unit="s^4/m^2",
        description="cubic scale-factor error of each accelerometer",
        equation="d_f_i = k_i f_i^3",
    )
