"""Gravity of the site: stronger than that of the model."""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    (gravity,) = small = errors("gravity")
    rate = Signals.up * 0
    force = Signals.up * gravity
    return influence_table(
        rate,
        force,
        small,
        name="site-gravity",
        components=["gravity"],
        unit="m/s^2",
        description="how much stronger gravity is than the model says",
        equation="d_f = dg up",
    )
