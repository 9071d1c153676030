"""Lag of the thermometers: they show T - tau dT/dt.

It acts through every temperature coefficient: what the modelled errors change by per kelvin is in the signals, by the estimates.
"""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    accel, gyro = small = errors("accel gyro")
    rate = Signals.gyro_temperature_slope.multiply_elementwise(Signals.gyro_temperature_rate * gyro)
    force = Signals.temperature_slope.multiply_elementwise(Signals.temperature_rate * accel)
    return influence_table(
        rate,
        force,
        small,
        name="thermometer-lag",
        components=["accel", "gyro"],
        unit="s",
        description="how long the thermometers lag behind the sensors",
        equation="T_read = T - tau dT/dt",
    )
