"""Offset of the thermometers.

It acts through every temperature coefficient: what the modelled errors change by per kelvin is in the signals, by the estimates.
"""

from sympy import ones

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    accel, gyro = small = errors("accel gyro")
    rate = Signals.gyro_temperature_slope.multiply_elementwise(-ones(3, 1) * gyro)
    force = Signals.temperature_slope.multiply_elementwise(-ones(3, 1) * accel)
    return influence_table(
        rate,
        force,
        small,
        name="thermometer-offset",
        components=["accel", "gyro"],
        unit="K",
        description="how much too high the thermometers read",
        equation="T_read = T + o",
    )
