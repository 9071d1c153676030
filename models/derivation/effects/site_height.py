"""Height of the site: higher than stated, so that gravity is less."""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    (height,) = small = errors("height")
    rate = Signals.up * 0
    force = Signals.up * Signals.gravity_by_height * height
    return influence_table(
        rate,
        force,
        small,
        name="site-height",
        components=["height"],
        unit="m",
        description="how much higher the site is than stated",
        equation="d_f = dg/dh dh up",
    )
