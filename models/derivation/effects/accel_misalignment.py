"""Installation errors of the accelerometers, all six since b is tied to the gyros."""

from sympy import Matrix

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f = Signals.force
    m = errors("m_xy m_xz m_yx m_yz m_zx m_zy")
    m_xy, m_xz, m_yx, m_yz, m_zx, m_zy = m
    M = Matrix([[0, m_xy, m_xz], [m_yx, 0, m_yz], [m_zx, m_zy, 0]])
    reading = f + M * f
    return sensor_table(
        FORCE,
        reading,
        m,
        name="accel-misalignment",
        components=["xy", "xz", "yx", "yz", "zx", "zy"],
        unit="rad",
        description="installation errors of the accelerometers; xy is what accelerometer x reads of the force along y",
        equation="d_f_i = sum over j != i of m_ij f_j",
        equations="Eq. 23, 35",
    )
