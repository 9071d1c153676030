"""Biases of the gyros."""

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    eps = errors("eps_x eps_y eps_z")
    reading = w + eps
    return sensor_table(
        RATE,
        reading,
        eps,
        name="gyro-bias",
        components=["x", "y", "z"],
        unit="rad/s",
        description="constant drift of each gyro",
        equation="d_omega_i = eps_i",
        equations="Eq. 22, 24-34",
    )
