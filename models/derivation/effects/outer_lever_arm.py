"""The outer lever arm l in b, from the IMU's sensitive centre to the point whose motion the reference reports."""

from sympy import zeros

from ..frames import Point, errors
from ._reference import reference_table


def table():
    C, w, l = Point.C, Point.rate_eb, Point.lever
    delta = errors("delta_x delta_y delta_z")
    estimate = l - delta
    velocity = C * w.cross(estimate) - C * w.cross(l)
    position = C * estimate - C * l
    return reference_table(
        [velocity, position, zeros(3, 1)],
        delta,
        name="outer-lever-arm",
        components=["x", "y", "z"],
        unit="m",
        description="vector from the sensitive centre to the observed point, in b",
        equation="z_v = v + C (omega_eb x l) - v_ref; z_p = p + C l - p_ref",
        equations="Eq. 36-37, 46-49",
    )
