"""Residuals by the sensor errors: a gyro error turns the lever arm's velocity, and is one of the rate (the matrix L)."""

from sympy import Matrix, zeros

from ..frames import POINT, Point, errors, linearise
from ..table import CHANNELS, INPUTS, PAPER, Table


def table():
    C, w, l = Point.C, Point.rate_eb, Point.lever
    d_omega, d_f = errors("d_omega_x d_omega_y d_omega_z"), errors("d_f_x d_f_y d_f_z")
    velocity = C * (w + d_omega).cross(l) - C * w.cross(l)
    inputs = Matrix([*d_omega, *d_f])
    return Table(
        name="strapdown-residual-input",
        kind="residual-input",
        description="residuals by the errors of the three gyros and the three accelerometers",
        equation="z_v = v + C ((omega_eb + d_omega) x l) - v_ref; z_r = omega_eb + d_omega - omega_eb_ref",
        source=f"Eq. 46-49 of {PAPER}",
        jacobian=linearise(Matrix.vstack(velocity, zeros(6, 1), d_omega), inputs).applyfunc(lambda e: e.expand()),
        rows=CHANNELS,
        columns=INPUTS,
        fields=POINT,
        share=False,
    )
