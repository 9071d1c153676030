"""Scale factors of the gyros that change with the size of the rate."""

from sympy import Abs, diag

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    k = errors("k_x k_y k_z")
    reading = w + diag(*k) * w.applyfunc(lambda w_i: w_i * Abs(w_i))
    return sensor_table(
        RATE,
        reading,
        k,
        name="gyro-rate-nonlinearity",
        components=["x", "y", "z"],
        unit="s/rad",
        description="change of each gyro's scale factor with the size of the rate",
        equation="d_omega_i = k_i omega_i |omega_i|",
    )
