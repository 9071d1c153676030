"""The size effect: what accelerometers feel because they do not sit at the sensitive centre.

Accelerometer i, displaced by r_i, reads u_i . (omega x (omega x r_i) + omega' x r_i) beyond the specific force at
the centre. Dither adds A sin(2 pi F t) about each axis to the rate, which the gyros' output has filtered away. The
three frequencies differ, so the mean over time is the mean over three independent phases.
"""

from sympy import Matrix, cos, integrate, pi, sin, symbols

from ..frames import Signals


def size_effect(displacements, dither):
    """Mean over the dither of the three extra readings; row i of `displacements` is r_i, `dither` stands for A^2/2."""
    A = symbols("A_x A_y A_z", positive=True)
    F = symbols("F_x F_y F_z", positive=True)
    phases = symbols("theta_x theta_y theta_z", real=True)
    w = Signals.rate + Matrix([a * sin(p) for a, p in zip(A, phases)])
    wd = Signals.angular_acceleration + Matrix([a * 2 * pi * f * cos(p) for a, f, p in zip(A, F, phases)])

    def reading(i):
        r = displacements[i, :].T
        extra = (w.cross(w.cross(r)) + wd.cross(r))[i].expand()
        for phase in phases:
            extra = (integrate(extra, (phase, 0, 2 * pi)) / (2 * pi)).expand()
        return extra.subs({a**2: 2 * a2 for a, a2 in zip(A, dither)}).expand()

    return Matrix([reading(i) for i in range(3)])
