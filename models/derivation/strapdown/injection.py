"""How sensor errors enter the navigation errors: the matrix B (Eq. 40-41)."""

from sympy import Matrix, eye, zeros

from ..frames import POINT, Point, errors, turned, unskew
from ..table import INPUTS, PAPER, STATES, Table


def table():
    C = Point.C
    d_omega, d_f = errors("d_omega_x d_omega_y d_omega_z"), errors("d_f_x d_f_y d_f_z")
    # E = C_hat C^T = I - [phi x]; from C' = C [omega_ib x] - [omega_in x] C the gyro errors alone give
    # E' = C [d_omega x] C^T, hence -[phi' x].
    attitude = -unskew(turned(C, d_omega) - eye(3))
    velocity = C * d_f
    inputs = Matrix([*d_omega, *d_f])
    return Table(
        name="strapdown-injection",
        kind="injection",
        description="navigation errors caused by the errors of the three gyros and the three accelerometers",
        equation="phi' = -C d_omega; dv' = C d_f",
        source=f"Eq. 40-41 of {PAPER}",
        jacobian=Matrix.vstack(attitude, velocity, zeros(3, 1)).jacobian(inputs),
        rows=[f"{s}'" for s in STATES],
        columns=INPUTS,
        fields=POINT,
        share=False,
    )
