"""Biases of the accelerometers."""

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    b = errors("b_x b_y b_z")
    reading = f + b
    return sensor_table(
        FORCE,
        reading,
        b,
        name="accel-bias",
        components=["x", "y", "z"],
        unit="m/s^2",
        description="constant bias of each accelerometer",
        equation="d_f_i = b_i",
        equations="Eq. 23, 35",
    )
