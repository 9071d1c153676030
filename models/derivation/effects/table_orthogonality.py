"""The axes of a three-axis table are not square, and the attitude it reports is that of square ones.

The outer axis o stands along up, the inner one i along the unit's x, and the middle one m along o x i. With angles of 90 deg + om between
o and m, and 90 deg + mi between m and i, C = R(o) N(om) R(m) N(mi) R(i), where N are small rotations about o x m and m x i, and the table
reports R(o) R(m) R(i). An attitude does not tell the angles of a table whose outer and inner axes are parallel, where m is any of many;
so m is taken as o x i itself, whose length goes to zero there, and with it what is said.
"""

from sympy import Matrix, eye, zeros

from ..frames import Point, attitude_error, errors, skew
from ._reference import reference_table


def table():
    delta, truth = errors("delta_om delta_mi"), errors("om mi")
    outer, inner = Matrix([0, 0, 1]), Point.C[:, 0]
    middle = outer.cross(inner)

    def reported(crooked):
        """What the table reports, times the transpose of what is."""
        return eye(3) - skew(crooked[0] * outer.cross(middle) + crooked[1] * middle.cross(inner))

    # the prediction is made with the estimate, which is delta less than the truth
    attitude = attitude_error(reported(truth - delta) * reported(truth).T).subs({s: 0 for s in truth})
    return reference_table(
        [zeros(3, 1), zeros(3, 1), attitude.expand()],
        delta,
        name="table-orthogonality",
        components=["om", "mi"],
        unit="rad",
        description="angles beyond 90 deg between outer (up), middle and inner (x) axis of the table that reports attitudes",
        equation="C_ref = (I - [(om o x m + mi m x i) x]) C; m = o x i",
    )
