"""Scale of the thermometers, from the reference temperature.

It acts through every temperature coefficient: what the modelled errors change by per kelvin is in the signals, by the estimates.
"""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    accel, gyro = small = errors("accel gyro")
    rate = Signals.gyro_temperature_slope.multiply_elementwise(-Signals.gyro_temperature * gyro)
    force = Signals.temperature_slope.multiply_elementwise(-Signals.temperature * accel)
    return influence_table(
        rate,
        force,
        small,
        name="thermometer-scale",
        components=["accel", "gyro"],
        unit="1",
        description="scale of the thermometers' reading of the distance from the reference temperature",
        equation="T_read - T_ref = (1 + s) (T - T_ref)",
    )
