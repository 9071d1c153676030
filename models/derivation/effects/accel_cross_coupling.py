"""Rectification of the product of the forces along the other two axes (vibropendulous error)."""

from sympy import Matrix, diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    k = errors("k_x k_y k_z")
    others = Matrix([f[1] * f[2], f[2] * f[0], f[0] * f[1]])
    reading = f + diag(*k) * others
    return sensor_table(
        FORCE,
        reading,
        k,
        name="accel-cross-coupling",
        components=["x", "y", "z"],
        unit="s^2/m",
        description="reading of each accelerometer in proportion to the product of the forces along the other two axes",
        equation="d_f_i = k_i f_j f_k",
    )
