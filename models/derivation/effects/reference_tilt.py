"""A reference that is not level: it reports every vector turned by a small tilt about east and north."""

from sympy import Matrix, eye

from ..frames import Point, attitude_error, errors, skew
from ._reference import reference_table


def table():
    delta = errors("delta_e delta_n")
    truth = errors("tilt_e tilt_n")
    tilt = Matrix([*truth, 0])
    estimate = Matrix([*(truth - delta), 0])
    difference = (eye(3) - skew(estimate)) - (eye(3) - skew(tilt))
    attitude = attitude_error((eye(3) - skew(estimate)) * (eye(3) - skew(tilt)).T)
    return reference_table(
        [difference * Point.point_velocity, difference * Point.point_position, attitude.subs({s: 0 for s in truth})],
        delta,
        name="reference-tilt",
        components=["e", "n"],
        unit="rad",
        description="small rotation of the reference's level about east and north",
        equation="x_ref = (I - [tilt x]) x; C_ref = (I - [tilt x]) C",
    )
