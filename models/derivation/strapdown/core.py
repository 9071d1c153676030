"""Navigation errors of a strapdown system: the matrix A (Eq. 40-42).

The differential equations of attitude, velocity and position are written down once and differentiated by everything
they depend on; the position error is then carried in metres east, north, up,

    dp = [ (R_N + h) cos L dlambda, (R_M + h) dL, dh ],

the rates of the metric factors included.
"""

from sympy import Function, Matrix, Symbol, cos, eye, sin, sqrt, symbols, tan

from ..frames import POINT, Point, errors, linearise, skew, unskew
from ..table import PAPER, STATES, Table

# WGS 84
A, F, OMEGA_IE, GM = 6378137.0, 1 / 298.257223563, 7.292115e-5, 3.986004418e14
GAMMA_E, SOMIGLIANA_K = 9.7803253359, 0.00193185265241

a, f, e2, omega_ie = symbols("a f e2 omega_ie", positive=True)
gamma_e, k, m = symbols("gamma_e k m", positive=True)
CONSTANTS = {
    a: A,
    f: F,
    e2: F * (2 - F),
    omega_ie: OMEGA_IE,
    gamma_e: GAMMA_E,
    k: SOMIGLIANA_K,
    m: OMEGA_IE**2 * A**3 * (1 - F) / GM,
}

L, h = Point.latitude, Point.height
R_M, R_N, gamma = Function("R_M")(L), Function("R_N")(L), Function("gamma")(L, h)


def earth():
    """Meridian radius, transverse radius and normal gravity: Somigliana, second order in height."""
    w = sqrt(1 - e2 * sin(L) ** 2)
    surface = gamma_e * (1 + k * sin(L) ** 2) / w
    return {
        R_M: a * (1 - e2) / w**3,
        R_N: a / w,
        gamma: surface * (1 - 2 / a * (1 + f + m - 2 * f * sin(L) ** 2) * h + 3 * h**2 / a**2),
    }


def steps():
    """Names for sines, radii, gravity and their derivatives, and the expressions behind them.

    Returns the steps in order, and the function that puts the names into an expression.
    """
    s, c, t, w = symbols("sin_l cos_l tan_l w", positive=True)
    square = 1 - e2 * sin(L) ** 2

    def short(e):
        e = e.replace(lambda x: x.is_Pow and x.base == square, lambda x: w ** (2 * x.exp))
        return e.subs({sin(L): s, cos(L): c})

    order = [(s, sin(L)), (c, cos(L)), (t, s / c), (w, sqrt(1 - e2 * s**2))]
    functions, derivatives = {}, {}
    for name, function in {"r_m": R_M, "r_n": R_N, "gamma": gamma}.items():
        value = earth()[function]
        functions[function] = Symbol(name, positive=True)
        order.append((functions[function], short(value)))
        for variable, suffix in [(L, "by_l"), (h, "by_h")]:
            derivative = function.diff(variable)
            if derivative != 0:
                derivatives[derivative] = Symbol(f"{name}_{suffix}", real=True)
                order.append((derivatives[derivative], short(value.diff(variable))))
    inverse_m, inverse_n = symbols("inverse_m inverse_n", positive=True)
    inverses = {functions[R_M] + h: 1 / inverse_m, functions[R_N] + h: 1 / inverse_n}
    order += [(symbol.as_base_exp()[0], 1 / radius) for radius, symbol in inverses.items()]

    def name(e):
        e = e.subs(derivatives).subs(functions).subs(inverses)
        e = e.subs({sin(L): s, cos(L): c, tan(L): t}).expand()
        return e.subs(s / c, t)

    return order, name


def table():
    v, f_n = Point.velocity, Point.force_n
    phi, dv, dp = errors("phi_e phi_n phi_u"), errors("dv_e dv_n dv_u"), errors("dp_e dp_n dp_u")
    states = Matrix([*phi, *dv, *dp])

    # The mechanisation.
    omega_e = Matrix([0, omega_ie * cos(L), omega_ie * sin(L)])
    omega_n = Matrix([-v[1] / (R_M + h), v[0] / (R_N + h), v[0] * tan(L) / (R_N + h)])
    omega_in = omega_e + omega_n
    turning = -(2 * omega_e + omega_n).cross(v) + Matrix([0, 0, -gamma])  # v' = C f + turning
    metres = Matrix([(R_N + h) * cos(L), R_M + h, 1])  # for longitude, latitude, height
    place_rate = Matrix([v[0] / metres[0], v[1] / metres[1], v[2]])  # longitude', latitude', height'

    # What a small change of position and velocity does to a function of both.
    place = dp.multiply_elementwise(metres.applyfunc(lambda x: 1 / x))  # d longitude, d latitude, d height

    def change(function):
        by_place = Matrix.hstack(function * 0, function.diff(L), function.diff(h))
        return function.jacobian(v) * dv + by_place * place

    # E = C_hat C^T = I - [phi x]; from C' = C [omega_ib x] - [omega_in x] C, with errors in place and velocity only:
    # E' = -[omega_in_hat x] E + E [omega_in x] = -[phi' x].
    E = eye(3) - skew(phi)
    attitude = -unskew(-skew(omega_in + change(omega_in)) * E + E * skew(omega_in))
    velocity = (E * f_n - f_n) + change(turning)
    metres_rate = metres.diff(L) * place_rate[1] + metres.diff(h) * place_rate[2]
    position = metres_rate.multiply_elementwise(place) + metres.multiply_elementwise(change(place_rate))

    order, name = steps()
    jacobian = linearise(Matrix.vstack(attitude, velocity, position), states).applyfunc(name)
    return Table(
        name="strapdown-core",
        kind="core",
        description="errors of attitude, velocity and position (metres east, north, up) without sensor errors",
        equation="phi' = -omega_in x phi + d_omega_in; dv' = f_n x phi - (2 omega_ie + omega_en) x dv"
        " - (2 d_omega_ie + d_omega_en) x v + d_g; d(L, lambda, h)' by v, L, h",
        source=f"Eq. 40-42 of {PAPER}",
        jacobian=jacobian,
        rows=[f"{s}'" for s in STATES],
        columns=STATES,
        fields=POINT,
        constants=CONSTANTS,
        steps=order,
    )
