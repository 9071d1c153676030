"""Biases of the gyros that wander about a mean and forget: first-order Gauss-Markov.

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
        name="gyro-bias-wander",
        components=["x", "y", "z"],
        unit="rad/s",
        description="wander of each bias of the gyros about its mean, at the end of the log",
        equation="d_omega_i = eps_i, eps_i' = -eps_i/tau + w",
    )
