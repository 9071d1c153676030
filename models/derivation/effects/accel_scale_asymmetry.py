"""Scale factors of the accelerometers that differ between pushing and pulling."""

from sympy import Abs, diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * f.applyfunc(Abs)
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-scale-asymmetry",
        components=["x", "y", "z"],
        unit="1",
        description="half the difference of each accelerometer's scale factor between positive and negative force",
        equation="d_f_i = k_i |f_i|",
    )
