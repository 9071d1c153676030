"""Scale of the clock that stamps the samples: an interval of a stamped second lasts (1 + c) seconds.

Increments are angles and velocities, whatever the clock says; what the mechanisation adds in a stamped second is the Earth's
rate and gravity of one second, where that of (1 + c) seconds was felt. So the sensors seem to read c times the Earth's rate and
c times the force against gravity too much. This is for a unit near its place: of one that travels the way is c times longer too.
"""

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    (c,) = small = errors("c")
    rate = Signals.earth_rate * c
    force = Signals.up * Signals.gravity * c
    return influence_table(
        rate,
        force,
        small,
        name="clock-scale",
        components=["c"],
        unit="1",
        description="part by which an interval lasts longer than the stamps say",
        equation="d_omega = c omega_ie, d_f = c g up",
    )
