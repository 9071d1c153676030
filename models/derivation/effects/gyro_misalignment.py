"""Installation errors of the gyros.

Lower triangular, since b is tied to the gyros: x_b along the x gyro, y_b in the plane of x and y gyro.
"""

from sympy import Matrix

from ..frames import Signals, errors
from ..table import RATE
from ._sensor import sensor_table


def table():
    w = Signals.rate
    m = errors("m_yx m_zx m_zy")
    m_yx, m_zx, m_zy = m
    M = Matrix([[0, 0, 0], [m_yx, 0, 0], [m_zx, m_zy, 0]])
    reading = w + M * w
    return sensor_table(
        RATE,
        reading,
        m,
        name="gyro-misalignment",
        components=["yx", "zx", "zy"],
        unit="rad",
        description="installation errors of the gyros; yx is what gyro y reads of the rate about x",
        equation="d_omega_y = m_yx omega_x; d_omega_z = m_zx omega_x + m_zy omega_y",
        equations="Eq. 22, 24-34",
    )
