"""Residuals of velocity, position and attitude by the navigation errors: the matrix H of the core (Eq. 46-49).

The rate omega_eb is what the compensated gyros give; its own change with phi, through C^T omega_ie, is neglected
(7e-5 rad/s times the lever arm: below 1e-4 m/s for each radian and metre). The residual of the rate itself is in `rate.py`.
"""

from sympy import Matrix, eye, zeros

from ..frames import POINT, Point, attitude_error, errors, linearise, skew
from ..table import CHANNELS, PAPER, STATES, Table


def table():
    C, w, l = Point.C, Point.rate_eb, Point.lever
    phi, dv, dp = errors("phi_e phi_n phi_u"), errors("dv_e dv_n dv_u"), errors("dp_e dp_n dp_u")
    C_hat = (eye(3) - skew(phi)) * C
    velocity = (Point.velocity + dv) + C_hat * w.cross(l) - (Point.velocity + C * w.cross(l))
    position = (Point.position + dp) + C_hat * l - (Point.position + C * l)
    attitude = attitude_error(eye(3) - skew(phi))  # C_hat C^T
    errors_ = Matrix([*phi, *dv, *dp])
    return Table(
        name="strapdown-residual",
        kind="residual",
        description="residuals of velocity, position and attitude by the navigation errors",
        equation="z_v = v + C (omega_eb x l) - v_ref; z_p = p + C l - p_ref; C_pred = (I - [z_a x]) C_ref",
        source=f"Eq. 46-49 of {PAPER}",
        jacobian=linearise(Matrix.vstack(velocity, position, attitude, zeros(3, 1)), errors_),
        rows=CHANNELS,
        columns=STATES,
        fields=POINT,
    )
