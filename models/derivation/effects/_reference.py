"""What the files of reference effects share."""

from sympy import Matrix, zeros

from ..frames import POINT, linearise
from ..table import CHANNELS, PAPER, Table


def reference_table(residuals, delta, *, name, components, unit, description, equation, equations=""):
    """Jacobian of the residuals, predicted - reference, by delta = truth - estimate of an effect's parameters.

    `residuals` are those of velocity, position and attitude (none acts on the rate), with the estimate written as truth - delta.
    """
    return Table(
        name=name,
        kind="measurement",
        description=description,
        equation=equation,
        source=f"{equations} of {PAPER}" if equations else f"not in {PAPER}",
        jacobian=linearise(Matrix.vstack(*residuals, zeros(3, 1)), delta),
        rows=CHANNELS,
        columns=components,
        fields=POINT,
        unit=unit,
        components=components,
    )
