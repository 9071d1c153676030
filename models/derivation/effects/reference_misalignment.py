"""A small rotation m, in b, from b to the body frame whose attitude the reference reports."""

from sympy import zeros

from ..frames import Point, attitude_error, errors, turned
from ._reference import reference_table


def table():
    C = Point.C
    m, delta = errors("m_x m_y m_z"), errors("delta_x delta_y delta_z")
    # C_ref = C (I + [m x]) for the true m, and the same with the estimate m - delta for the prediction.
    predicted = turned(C, m - delta)  # times C
    reference = turned(C, m)  # times C
    attitude = attitude_error(predicted * reference.T).subs({s: 0 for s in m})
    return reference_table(
        [zeros(3, 1), zeros(3, 1), attitude],
        delta,
        name="reference-misalignment",
        components=["x", "y", "z"],
        unit="rad",
        description="small rotation, in b, from b to the body frame of the reference's attitude",
        equation="C_ref = C (I + [m x])",
    )
