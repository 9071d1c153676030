"""The reference reads too large: velocity and position are (1 + s) times what they are."""

from sympy import zeros

from ..frames import Point, errors
from ._reference import reference_table


def table():
    (ds,) = delta = errors("delta_s")
    # the prediction is made with the estimate, which is delta less than the truth
    return reference_table(
        [-Point.point_velocity * ds, -Point.point_position * ds, zeros(3, 1)],
        delta,
        name="reference-scale",
        components=["s"],
        unit="1",
        description="scale of the reference's velocity and position",
        equation="reading = (1 + s) x",
    )
