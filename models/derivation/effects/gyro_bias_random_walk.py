"""Biases of the gyros that walk away from what they were at the first row.

At one instant they read as biases do; how they move is for the block to say.
"""

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    bias = errors("eps_x eps_y eps_z")
    return sensor_table(
        RATE,
        Signals.rate + bias,
        bias,
        name="gyro-bias-random-walk",
        components=["x", "y", "z"],
        unit="rad/s",
        description="how far each bias of the gyros has walked since the first row, at the end of the log",
        equation="d_omega_i = eps_i, eps_i' = w",
    )
