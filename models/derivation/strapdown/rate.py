"""Residual of the body's rate against the Earth by the navigation errors.

The gyros measure omega_ib; the rate against the Earth is what is left of it without C^T omega_ie, and that turns with the attitude
error and changes with the latitude.
"""

from sympy import Matrix, cos, eye, sin, zeros

from ..frames import POINT, Point, errors, linearise, skew
from ..table import CHANNELS, STATES, Table
from .core import CONSTANTS, R_M, L, h, omega_ie, steps


def table():
    phi, dv, dp = errors("phi_e phi_n phi_u"), errors("dv_e dv_n dv_u"), errors("dp_e dp_n dp_u")
    omega_e = Matrix([0, omega_ie * cos(L), omega_ie * sin(L)])
    computed = omega_e + omega_e.diff(L) * dp[1] / (R_M + h)
    rate = -((eye(3) - skew(phi)) * Point.C).T * computed + Point.C.T * omega_e
    order, name = steps()
    states = Matrix([*phi, *dv, *dp])
    return Table(
        name="strapdown-rate",
        kind="residual",
        description="residual of the body's rate by the navigation errors",
        equation="z_r = omega_ib - C^T omega_ie - omega_eb_ref",
        source="perturbed here",
        jacobian=linearise(Matrix.vstack(zeros(9, 1), rate), states).applyfunc(name),
        rows=CHANNELS,
        columns=STATES,
        fields=POINT,
        constants=CONSTANTS,
        steps=order,
    )
