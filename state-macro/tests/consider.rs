//! Considered states, marked by the derive, on a family of dynamics small enough for dense matrices.

mod toy;

use calib_core::{Conventional, Filter, Form, Kalman, Residuals, Shape, Transition, Ud, measurement_rows};
use state_macro::StateBlocks;
use toy::{Beacon, Bias, Force, Place, PlaceSeen, Rail, Scale, Speed, SpeedSeen};

/// A cart that takes the scale of its accelerometer and the place of the beacon from elsewhere.
#[derive(StateBlocks)]
#[filter(dynamics = Rail, measures(PlaceSeen, SpeedSeen), crate = calib_core)]
struct Considering {
    place: Place,
    speed: Speed,
    #[consider]
    scale: Scale,
    bias: Bias,
    aids: Aids,
}

#[derive(StateBlocks)]
#[group(dynamics = Rail, crate = calib_core)]
struct Aids {
    #[consider]
    beacon: Beacon,
}

/// The same, estimated.
#[derive(StateBlocks)]
#[filter(dynamics = Rail, measures(PlaceSeen, SpeedSeen), crate = calib_core)]
struct Estimating {
    place: Place,
    speed: Speed,
    scale: Scale,
    bias: Bias,
    beacon: Beacon,
}

const N: usize = 5;
const M: usize = 2;
const CONSIDERED: [usize; 2] = [2, 4];
const SIGMAS: [f64; N] = [1.0, 0.5, 0.01, 0.05, 0.3];
const READING: [f64; M] = [0.2, 0.05];
const DENSITY: f64 = 1e-4;

type Square = [[f64; N]; N];

/// Numbers that are nearly normal: sums of twelve that are uniform.
struct Numbers(u64);

impl Numbers {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

fn product(a: &Square, b: &Square) -> Square {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Square) -> Square {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

/// What the cart feels in interval `k`.
fn force(k: usize) -> Force<f64> {
    Force { force: 2.0 * (0.7 * k as f64).sin() + 0.5 }
}

struct Step<F: Filter> {
    transition: Transition<F, f64>,
    phi: Square,
    noise: Square,
    h: [[f64; N]; M],
    signals: Force<f64>,
}

fn step<F: Filter<Dynamics = Rail>>(k: usize) -> Step<F> {
    let mut transition = Transition::<F, f64>::new();
    for _ in 0..10 {
        transition.absorb(&(), &force(k), 0.1);
        transition.advance(&(), 0.1);
    }
    let noise = transition.noise(&density::<F>());
    let rows = transition.rows();
    let phi = core::array::from_fn(|i| {
        core::array::from_fn(|j| if i < 2 { rows[i][j] } else { f64::from(u8::from(i == j)) })
    });
    let noise =
        core::array::from_fn(|i| core::array::from_fn(|j| if i < 2 && j < 2 { noise[i][j] } else { 0.0 }));
    let signals = force(k);
    let h = measurement_rows::<F, f64>(&(), &signals);
    let h = core::array::from_fn(|m| core::array::from_fn(|j| h[m][j]));
    Step { transition, phi, noise, h, signals }
}

fn density<F: Filter>() -> calib_core::CoreVector<F, f64> {
    let mut density = F::Shape::core_vector(0.0);
    density[1] = DENSITY;
    density
}

fn kalman<F: Filter, C: Form>() -> Kalman<F, f64, C> {
    let mut sigmas = F::Shape::vector(0.0);
    (0..N).for_each(|i| sigmas[i] = SIGMAS[i]);
    Kalman::new(&sigmas)
}

fn take<F: Filter<Dynamics = Rail>, C: Form>(kalman: &mut Kalman<F, f64, C>, step: &Step<F>, z: [f64; M]) {
    kalman.predict(&step.transition, &density::<F>());
    let mut residuals = Residuals::<F, f64>::default();
    (0..M).for_each(|m| residuals.set(m, z[m], READING[m]));
    kalman.update(&(), &step.signals, residuals, None).expect("a sound update");
}

/// Schmidt's equations with dense matrices: the gain of the usual filter without its rows of considered states, and Joseph's form, which
/// holds for any gain.
fn oracle<C: Form>() {
    let mut kalman = kalman::<Considering, C>();
    let mut p: Square =
        core::array::from_fn(|i| core::array::from_fn(|j| if i == j { SIGMAS[i] * SIGMAS[i] } else { 0.0 }));
    let mut x = [0.0; N];
    let mut numbers = Numbers(9);
    for k in 0..40 {
        let step = step::<Considering>(k);
        let z = [numbers.normal(), 0.1 * numbers.normal()];
        take(&mut kalman, &step, z);
        x = core::array::from_fn(|i| (0..N).map(|j| step.phi[i][j] * x[j]).sum());
        p = product(&product(&step.phi, &p), &transposed(&step.phi));
        (0..N).for_each(|i| (0..N).for_each(|j| p[i][j] += step.noise[i][j]));
        let ph: [[f64; M]; N] =
            core::array::from_fn(|i| core::array::from_fn(|m| (0..N).map(|j| p[i][j] * step.h[m][j]).sum()));
        let s: [[f64; M]; M] = core::array::from_fn(|m| {
            core::array::from_fn(|l| {
                let noise = if m == l { READING[m] * READING[m] } else { 0.0 };
                (0..N).map(|j| step.h[m][j] * ph[j][l]).sum::<f64>() + noise
            })
        });
        let det = s[0][0] * s[1][1] - s[0][1] * s[1][0];
        let inverse = [[s[1][1] / det, -s[0][1] / det], [-s[1][0] / det, s[0][0] / det]];
        let gain: [[f64; M]; N] = core::array::from_fn(|i| {
            core::array::from_fn(|m| {
                if CONSIDERED.contains(&i) { 0.0 } else { (0..M).map(|l| ph[i][l] * inverse[l][m]).sum() }
            })
        });
        let seen: [f64; M] =
            core::array::from_fn(|m| z[m] - (0..N).map(|j| step.h[m][j] * x[j]).sum::<f64>());
        (0..N).for_each(|i| x[i] += (0..M).map(|m| gain[i][m] * seen[m]).sum::<f64>());
        let rest: Square = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                f64::from(u8::from(i == j)) - (0..M).map(|m| gain[i][m] * step.h[m][j]).sum::<f64>()
            })
        });
        p = product(&product(&rest, &p), &transposed(&rest));
        for i in 0..N {
            for j in 0..N {
                p[i][j] += (0..M).map(|m| gain[i][m] * READING[m] * READING[m] * gain[j][m]).sum::<f64>();
            }
        }
        let found = kalman.covariance();
        for i in 0..N {
            assert!(
                (kalman.x()[i] - x[i]).abs() < 1e-10 * p[i][i].sqrt(),
                "{k}, {i}: {} {}",
                kalman.x()[i],
                x[i]
            );
            for j in 0..N {
                let scale = (p[i][i] * p[j][j]).sqrt();
                assert!(
                    (found[i][j] - p[i][j]).abs() < 1e-10 * scale,
                    "{k}, {i}, {j}: {} {}",
                    found[i][j],
                    p[i][j]
                );
            }
            assert_eq!(kalman.is_considered(i), CONSIDERED.contains(&i));
        }
    }
    for i in CONSIDERED {
        assert!(kalman.x()[i] == 0.0 && (kalman.sigma(i) / SIGMAS[i] - 1.0).abs() < 1e-12);
    }
}

#[test]
fn both_forms_are_those_of_schmidt() {
    oracle::<Conventional>();
    oracle::<Ud>();
}

/// All others are known worse than where the states are estimated, and than where they are exact.
#[test]
fn a_considered_state_makes_no_other_look_better_known() {
    let mut considering = kalman::<Considering, Ud>();
    let mut estimating = kalman::<Estimating, Ud>();
    let mut exact = {
        let mut sigmas = <Estimating as Filter>::Shape::vector(0.0);
        (0..N).filter(|i| !CONSIDERED.contains(i)).for_each(|i| sigmas[i] = SIGMAS[i]);
        Kalman::<Estimating, f64, Ud>::new(&sigmas)
    };
    for k in 0..40 {
        take(&mut considering, &step(k), [0.0; M]);
        take(&mut estimating, &step(k), [0.0; M]);
        take(&mut exact, &step(k), [0.0; M]);
        for i in (0..N).filter(|i| !CONSIDERED.contains(i)) {
            let most = considering.sigma(i) * (1.0 + 1e-12);
            assert!(estimating.sigma(i) <= most && exact.sigma(i) <= most, "{k}, {i}");
        }
    }
    assert!(considering.sigma(3) > 1.5 * exact.sigma(3), "nothing was considered");
}

/// With what is considered drawn from its prior, errors are as large as the filter says.
#[test]
fn errors_are_as_large_as_stated() {
    const UNITS: usize = 4000;
    let path: Vec<Step<Considering>> = (0..30).map(step).collect();
    let mut numbers = Numbers(77);
    let mut squares = [0.0; N];
    let mut sigmas = [0.0; N];
    for _ in 0..UNITS {
        let mut kalman = kalman::<Considering, Conventional>();
        let mut truth: [f64; N] = core::array::from_fn(|i| SIGMAS[i] * numbers.normal());
        for step in &path {
            truth = core::array::from_fn(|i| (0..N).map(|j| step.phi[i][j] * truth[j]).sum());
            // a factor of the noise of place and speed
            let (a, b) = (numbers.normal(), numbers.normal());
            let [speed, cross] = [step.noise[1][1].sqrt(), step.noise[0][1]];
            truth[1] += speed * a;
            truth[0] +=
                cross / speed * a + (step.noise[0][0] - cross * cross / step.noise[1][1]).max(0.0).sqrt() * b;
            let z = core::array::from_fn(|m| {
                (0..N).map(|j| step.h[m][j] * truth[j]).sum::<f64>() + READING[m] * numbers.normal()
            });
            take(&mut kalman, step, z);
        }
        for i in 0..N {
            squares[i] += ((kalman.x()[i] - truth[i]) / kalman.sigma(i)).powi(2) / UNITS as f64;
            sigmas[i] = kalman.sigma(i);
        }
    }
    for i in 0..N {
        // a mean of 4000 squares is within 0.09 of 1 in 9999 cases of 10 000
        assert!((squares[i] - 1.0).abs() < 0.09, "{i}: {}, sigma {}", squares[i], sigmas[i]);
    }
}
