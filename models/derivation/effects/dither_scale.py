"""Scale of the dither's pick-offs: they read (1 + k) times the amplitude.

It acts through the inner lever arms: these feel the dither's mean square, A^2/2, which is taken (1 + k)^2 times too large. The arms are in
the signals, by the estimates.
"""

from sympy import Matrix

from ..frames import Signals, errors
from ._sensor import influence_table


def table():
    k = errors("k_x k_y k_z")
    felt = [Signals.coupled_dither[j] / (1 + k[j]) ** 2 for j in range(3)]
    force = Matrix([-Signals.arms[i] * sum(felt[j] for j in range(3) if j != i) for i in range(3)])
    return influence_table(
        Signals.up * 0,
        force,
        k,
        name="dither-scale",
        components=["x", "y", "z"],
        unit="1",
        description="scale of the dither amplitudes that are read",
        equation="A_read = (1 + k) A",
    )
