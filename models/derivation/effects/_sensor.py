"""What the files of sensor effects share."""

from sympy import Matrix, zeros

from ..frames import SIGNALS, Signals, linearise
from ..table import FORCE, INPUTS, PAPER, Table


def sensor_table(first, reading, parameters, *, name, components, unit, description, equation, equations=""):
    """Jacobian of a sensor's error, reading - truth, by the parameters of an effect.

    `first` is RATE or FORCE, `reading` the three readings with the effect in them. What is left after
    compensation with an estimate is this Jacobian times delta = truth - estimate.
    """
    truth = Signals.force if first == FORCE else Signals.rate
    jacobian = zeros(6, len(parameters))
    jacobian[first : first + 3, :] = linearise(reading - truth, parameters)
    return Table(
        name=name,
        kind="force" if first == FORCE else "rate",
        description=description,
        equation=equation,
        source=f"{equations} of {PAPER}" if equations else f"not in {PAPER}",
        jacobian=jacobian,
        rows=INPUTS,
        columns=components,
        fields=SIGNALS,
        unit=unit,
        components=components,
    )


def influence_table(rate, force, parameters, *, name, components, unit, description, equation):
    """Jacobian of what an influence from outside seems to add to the readings of both triads."""
    return Table(
        name=name,
        kind="sensors",
        description=description,
        equation=equation,
        source=f"not in {PAPER}",
        jacobian=linearise(Matrix.vstack(rate, force), parameters),
        rows=INPUTS,
        columns=components,
        fields=SIGNALS,
        unit=unit,
        components=components,
    )
