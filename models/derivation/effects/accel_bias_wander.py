"""Biases of the accelerometers that wander about a mean and forget: first-order Gauss-Markov.

At one instant they read as biases do; how they move is for the block to say.
"""

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    bias = errors("b_x b_y b_z")
    return sensor_table(
        FORCE,
        Signals.force + bias,
        bias,
        name="accel-bias-wander",
        components=["x", "y", "z"],
        unit="m/s^2",
        description="wander of each bias of the accelerometers about its mean, at the end of the log",
        equation="d_f_i = b_i, b_i' = -b_i/tau + w",
    )
