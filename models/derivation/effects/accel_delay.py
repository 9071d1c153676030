"""Delay of the accelerometers against the gyros.

The sample stamped t was felt at t - tau. Where the specific force in n does not change, it was turned by the
rotation of the body in between: f_b(t - tau) = C(t - tau)^T C(t) f_b(t), here with Rodrigues' formula.
"""

from sympy import cos, eye, sin

from ..frames import Signals, errors, skew
from ..table import FORCE
from ._sensor import sensor_table


def table():
    f, w = Signals.force, Signals.rate
    (tau,) = delay = errors("tau")
    rate = w.norm()
    W = skew(w / rate)
    turn = eye(3) - sin(rate * tau) * W + (1 - cos(rate * tau)) * W**2  # C(t)^T C(t - tau)
    reading = turn.T * f
    return sensor_table(
        FORCE,
        reading,
        delay,
        name="accel-delay",
        components=["tau"],
        unit="s",
        description="how much later than the gyros the accelerometers are stamped",
        equation="d_f = tau (omega x f)",
        equations="Eq. 12-21",
    )
