//! One 43-state cycle: propagate with Phi and Psi over an interval, six-measurement update, full covariance. And
//! what is assembled for it, and a sample of navigation.
//!
//! `cargo bench --bench cycle`; `cargo bench --bench cycle -- --least` prints the least of many short repetitions
//! instead of statistics, which a busy machine disturbs little. Each timing runs cycles in a row on the same
//! covariance, as a filter does. Every peer is checked to give the same covariance before it is timed. The two forms and
//! nalgebra's dynamic matrices are timed by `sinscal::check::bench`, which does the same for any filter. Other crates stand
//! in `benches/peers`, which runs all of this too.

#[path = "case/bench.rs"]
pub(crate) mod bench;
pub(crate) mod case;
#[path = "case/dense.rs"]
mod dense;
#[path = "case/navigation.rs"]
mod navigation;

use std::hint::black_box;

use bench::Bench;
use calib_core::Conventional;
use case::{F, N, case, check, cycle, interval, point, signals};
use dense::Dense;
use nalgebra::SMatrix;
use navigation::{Navigation, PERIOD};

type Peer = fn(&Dense<N>, &mut SMatrix<f64, N, N>);

/// Cycles in a row.
pub(crate) const CYCLES: u32 = 10;

fn forms(bench: &mut Bench) {
    let mut time = |name: &str, cycle: &mut dyn FnMut()| bench.run(name, CYCLES, || (), |()| cycle());
    sinscal::check::bench::<F>(&point(), &signals(), &mut time).expect("equal covariances");

    let case = case();
    let mut want = case.p;
    cycle::<Conventional>(&case, &mut want);
    let dense = Dense::new(&case.rows, &case.noise, &case.h, &case.r);
    let start = SMatrix::from_fn(|i, j| case.p[i][j]);
    let peers: [(&str, Peer); 3] = [
        ("nalgebra, static, nine rows by hand", Dense::nine_rows),
        ("nalgebra, static, (I - K H) P", Dense::short),
        ("nalgebra, static, Joseph", Dense::joseph),
    ];
    for (name, run) in peers {
        let mut p = start;
        run(&dense, &mut p);
        check(name, |i, j| p[(i, j)], &want);
        bench.run(name, CYCLES, || start, |p| run(&dense, p));
    }
}

/// Nanoseconds each: the clock needs a hundred of them.
fn assembly(bench: &mut Bench) {
    let (at, signals) = (point(), signals());
    let density = [1e-13; 9];
    bench.run("a sample absorbed into [Phi Psi]", 100, interval, |transition| {
        transition.absorb(black_box(&at), black_box(&signals), 1e-9);
    });
    bench.run("[Phi Psi] through a step of the dynamics", 100, interval, |transition| {
        transition.advance(black_box(&at), 1e-9);
    });
    bench.run("process noise of an interval", 100, interval, |transition| {
        transition.noise(black_box(&density))
    });
    bench.run(
        "measurement matrix",
        100,
        || (),
        |()| calib_core::measurement_rows::<F, f64>(black_box(&at), black_box(&signals)),
    );
    bench.run("a sample of navigation", PERIOD, Navigation::new, Navigation::step);
}

pub(crate) fn all(bench: &mut Bench) {
    forms(bench);
    assembly(bench);
}

#[allow(dead_code, reason = "benches/peers has its own")]
fn main() {
    let mut bench = Bench::from_arguments();
    all(&mut bench);
    bench.finish();
}
