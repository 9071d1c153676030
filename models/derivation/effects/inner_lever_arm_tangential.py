"""Size effect of accelerometers displaced across their own axes; the mean effect of dither on it is zero.

Together with `inner_lever_arm` and the outer lever arm it has three directions that no motion shows: a common shift
of the three accelerometers is the same as moving the outer lever arm.
"""

from sympy import Matrix

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table
from ._size_effect import size_effect


def table():
    r = errors("r_xy r_xz r_yx r_yz r_zx r_zy")
    r_xy, r_xz, r_yx, r_yz, r_zx, r_zy = r
    displacements = Matrix([[0, r_xy, r_xz], [r_yx, 0, r_yz], [r_zx, r_zy, 0]])
    reading = Signals.force + size_effect(displacements, Signals.coupled_dither)
    return sensor_table(
        FORCE,
        reading,
        r,
        name="inner-lever-arm-tangential",
        components=["xy", "xz", "yx", "yz", "zx", "zy"],
        unit="m",
        description="displacement of each accelerometer across its own axis; xy is accelerometer x displaced along y",
        equation="d_f_i = u_i . (omega x (omega x r_i) + omega' x r_i), r_i perpendicular to u_i",
        equations="Eq. 1-5",
    )
