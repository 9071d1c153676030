"""Delay of the accelerometers against the gyros.

The sample stamped t was felt at t - tau: it shows the specific force in b of another instant, whatever moved it there, the
body's rotation or its acceleration. Only where the specific force in n is constant, on a turntable, is this tau (omega x f).
"""

from ..frames import Signals, errors
from ..table import FORCE
from ._sensor import sensor_table


def table():
    (tau,) = delay = errors("tau")
    reading = Signals.force - tau * Signals.force_rate  # f_b(t - tau) to first order
    return sensor_table(
        FORCE,
        reading,
        delay,
        name="accel-delay",
        components=["tau"],
        unit="s",
        description="how much later than the gyros the accelerometers are stamped",
        equation="d_f = -tau f_b'",
        equations="Eq. 12-21",
    )
