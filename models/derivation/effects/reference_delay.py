"""The reference is stamped late: its reading at stamp t shows the observed point and the body at t - tau."""

from ..frames import Point, attitude_error, errors, turned
from ._reference import reference_table


def table():
    (dtau,) = delta = errors("delta_tau")
    # The prediction is made for t - estimate, that is later than t - truth by delta.
    velocity = Point.point_acceleration * dtau
    position = Point.point_velocity * dtau + Point.point_acceleration * dtau**2 / 2
    # C(t + dtau) C(t)^T = C (I + [omega_eb dtau x]) C^T
    attitude = attitude_error(turned(Point.C, Point.rate_eb * dtau))
    return reference_table(
        [velocity, position, attitude],
        delta,
        name="reference-delay",
        components=["tau"],
        unit="s",
        description="how late the reference is stamped",
        equation="reading(t) = x(t - tau)",
    )
