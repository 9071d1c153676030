"""Scale factors of the accelerometers that change with temperature."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    reading = f + diag(*k) * Signals.temperature.multiply_elementwise(f)
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-temperature-scale",
        components=["x", "y", "z"],
        unit="1/K",
        description="change of each accelerometer's scale factor with its temperature above the reference",
        equation="d_f_i = k_i (T_i - T_ref) f_i",
        equations="Eq. 35 and section 2.4",
    )
