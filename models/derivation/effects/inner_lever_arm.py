"""Size effect of accelerometers displaced along their own axes, with the mean effect of dither."""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table
from ._size_effect import size_effect


def table():
    r = errors("r_x r_y r_z")
    reading = Signals.force + size_effect(diag(*r), Signals.coupled_dither)
    return sensor_table(
        FORCE,
        reading,
        r,
        name="inner-lever-arm",
        components=["x", "y", "z"],
        unit="m",
        description="displacement of each accelerometer along its own axis from the sensitive centre",
        equation="d_f_i = -(omega_j^2 + omega_k^2 + A_j^2/2 + A_k^2/2) r_i",
        equations="Eq. 1-11",
    )
