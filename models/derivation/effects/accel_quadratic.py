"""Quadratic (even) scale-factor errors of the accelerometers."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * f.multiply_elementwise(f)
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-quadratic",
        components=["x", "y", "z"],
        unit="s^2/m",
        description="quadratic scale-factor error of each accelerometer",
        equation="d_f_i = k_i f_i^2",
        equations="Eq. 23, 35",
    )
