"""Frames, signs and the symbols that tables take their inputs from.

n is east-north-up at the current position, b is right-forward-up, `C` turns b components into n components.
The error of a navigation quantity is computed - true, the attitude error phi is C_hat = (I - [phi x]) C.
The error of a sensor is measured - true. A parameter state is delta = truth - estimate.
"""

from sympy import Matrix, Symbol, cos, eye, sin, symbols

SIGNALS = {}  # symbol -> field of `Signals`
POINT = {}  # symbol -> field of `Point`


def _vector(known, prefix, axes, field):
    components = [Symbol(f"{prefix}_{axis}", real=True) for axis in axes]
    known.update({s: f"{field}.{c}" for s, c in zip(components, "xyz")})
    return Matrix(components)


def _scalar(known, name, field):
    known[symbol := Symbol(name, real=True)] = field
    return symbol


class Signals:
    """What the sensors feel, along the body axes."""

    rate = _vector(SIGNALS, "w", "xyz", "rate")
    angular_acceleration = _vector(SIGNALS, "wd", "xyz", "angular_acceleration")
    force = _vector(SIGNALS, "f", "xyz", "force")
    force_rate = _vector(SIGNALS, "fd", "xyz", "force_rate")  # its derivative as the body sees it
    temperature = _vector(SIGNALS, "t", "xyz", "temperature")  # at each accelerometer, minus the reference
    temperature_rate = _vector(SIGNALS, "td", "xyz", "temperature_rate")
    gyro_temperature = _vector(SIGNALS, "tg", "xyz", "gyro_temperature")  # at each gyro, minus the reference
    dither = _vector(SIGNALS, "a2", "xyz", "dither")  # A^2/2
    coupled_dither = _vector(SIGNALS, "c2", "xyz", "coupled_dither")  # A^2/2 where `Dither` is declared, else zero
    time = _scalar(SIGNALS, "time", "time")
    # what the site does, along the body axes
    up = _vector(SIGNALS, "u", "xyz", "up")
    earth_rate = _vector(SIGNALS, "e", "xyz", "earth_rate")
    earth_turn = _vector(SIGNALS, "et", "xyz", "earth_turn")  # its derivative by latitude
    gravity = _scalar(SIGNALS, "g", "gravity")
    gravity_by_latitude = _scalar(SIGNALS, "g_l", "gravity_by_latitude")
    gravity_by_height = _scalar(SIGNALS, "g_h", "gravity_by_height")
    # what the estimates say
    gyro_temperature_rate = _vector(SIGNALS, "tgd", "xyz", "gyro_temperature_rate")
    temperature_slope = _vector(SIGNALS, "fs", "xyz", "temperature_slope")  # of an accelerometer's error by its temperature
    gyro_temperature_slope = _vector(SIGNALS, "ws", "xyz", "gyro_temperature_slope")  # of a gyro's
    arms = _vector(SIGNALS, "r", "xyz", "arms")  # inner lever arms that the dither acts through


class Point:
    """Where the strapdown error model is linearised."""

    C = Matrix(3, 3, lambda i, j: _scalar(POINT, f"c_{i}{j}", f"c_bn.m{i + 1}{j + 1}"))
    velocity = _vector(POINT, "v", "enu", "velocity")
    latitude = _scalar(POINT, "latitude", "latitude")
    height = _scalar(POINT, "height", "height")
    position = _vector(POINT, "p", "enu", "position")
    force_n = _vector(POINT, "f", "enu", "force_n")
    rate_eb = _vector(POINT, "w", "xyz", "rate_eb")
    lever = _vector(POINT, "l", "xyz", "lever")
    point_velocity = _vector(POINT, "pv", "enu", "point_velocity")
    point_acceleration = _vector(POINT, "pa", "enu", "point_acceleration")
    point_position = _vector(POINT, "pp", "enu", "point_position")


def errors(names):
    """Small quantities, to be differentiated by and then set to zero."""
    return Matrix(symbols(names, real=True, seq=True))


def skew(a):
    """[a x]: skew(a) * b = a x b."""
    return Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def unskew(m):
    """The vector whose skew matrix is the antisymmetric part of m."""
    return Matrix([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / 2


def turned(C, small):
    """C (I + [small x]) C^T for a rotation C, that is I + [(C small) x] (see `check_identities`)."""
    return eye(3) + skew(C * small)


def attitude_error(E):
    """z of C_a C_b^T = E = I - [z x]."""
    return -unskew(E)


def linearise(function, small):
    """Derivative of a column of functions by small quantities, where these vanish."""
    zero = {s: 0 for s in small}
    return function.jacobian(small).subs(zero)


def check_identities():
    """C [a x] C^T = [(C a) x] for every rotation, shown for three successive elementary ones."""
    x, y, z = symbols("x y z", real=True)
    a = errors("a:3")
    Rx = Matrix([[1, 0, 0], [0, cos(x), -sin(x)], [0, sin(x), cos(x)]])
    Ry = Matrix([[cos(y), 0, sin(y)], [0, 1, 0], [-sin(y), 0, cos(y)]])
    Rz = Matrix([[cos(z), -sin(z), 0], [sin(z), cos(z), 0], [0, 0, 1]])
    for R in (Rx, Ry, Rz):  # and what holds for factors holds for their product
        difference = (R * skew(a) * R.T - skew(R * a)).applyfunc(lambda e: e.expand().trigsimp())
        assert difference.is_zero_matrix, "C [a x] C^T = [(C a) x] does not hold"
