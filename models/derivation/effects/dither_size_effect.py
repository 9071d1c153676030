"""What dither alone makes of accelerometers displaced along their own axes.

The size effect with dither minus the size effect without, as three states of its own.
"""

from sympy import diag

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table
from ._size_effect import size_effect


def table():
    r = errors("r_x r_y r_z")
    still = {a2: 0 for a2 in Signals.dither}
    felt = size_effect(diag(*r), Signals.dither)
    reading = Signals.force + (felt - felt.subs(still)).expand()
    return sensor_table(
        FORCE,
        reading,
        r,
        name="dither-size-effect",
        components=["x", "y", "z"],
        unit="m",
        description="displacement of each accelerometer along its own axis as dither shows it",
        equation="d_f_i = -(A_j^2/2 + A_k^2/2) r_i",
        equations="Eq. 6-11",
    )
