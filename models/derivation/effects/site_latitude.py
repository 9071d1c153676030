"""Latitude of the site: further north than stated."""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    (latitude,) = small = errors("latitude")
    rate = Signals.earth_turn * latitude
    force = Signals.up * Signals.gravity_by_latitude * latitude
    return influence_table(
        rate,
        force,
        small,
        name="site-latitude",
        components=["latitude"],
        unit="rad",
        description="how much further north the site is than stated",
        equation="d_omega = d omega_ie/dL dL, d_f = dg/dL dL up",
    )
