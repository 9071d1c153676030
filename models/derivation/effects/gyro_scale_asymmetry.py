"""Scale factors of the gyros that differ between the two senses of rotation."""

from sympy import Abs, diag

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    k = errors("k_x k_y k_z")
    reading = w + diag(*k) * w.applyfunc(Abs)
    return sensor_table(
        RATE,
        reading,
        k,
        name="gyro-scale-asymmetry",
        components=["x", "y", "z"],
        unit="1",
        description="half the difference of each gyro's scale factor between positive and negative rate",
        equation="d_omega_i = k_i |omega_i|",
    )
