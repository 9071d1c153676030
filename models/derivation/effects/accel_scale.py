"""Scale-factor errors of the accelerometers."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    s = errors("s_x s_y s_z")
    reading = f + diag(*s) * f
    return sensor_table(
        FORCE,
        reading,
        s,
        name="accel-scale",
        components=["x", "y", "z"],
        unit="1",
        description="scale-factor error of each accelerometer",
        equation="d_f_i = s_i f_i",
        equations="Eq. 23, 35",
    )
