//! How a cycle grows with states and with measurements, in both forms and, with six measurements, by hand in
//! nalgebra.
//!
//! `cargo bench --bench growth`; `-- --least` prints the least of many short repetitions instead of statistics.

#[path = "case/bench.rs"]
mod bench;
#[path = "case/dense.rs"]
#[allow(dead_code, reason = "only the quickest way is taken")]
mod dense;
#[path = "case/wave.rs"]
mod wave;

use bench::Bench;
use calib_core::{Conventional, Dim, Form, Ud};
use dense::Dense;
use nalgebra::SMatrix;
use wave::{Size, Wave, sizes};

/// Cycles in a row.
const CYCLES: u32 = 10;

struct Growth {
    bench: Bench,
}

impl Growth {
    fn form<C: Form, const N: usize, const M: usize>(&mut self, form: &str) {
        let wave = Wave::<Dim<N, 9, M>>::new();
        let start = (wave.start::<C>(), [0.0; N]);
        self.bench.run(&format!("{form} {N} {M}"), CYCLES, || start, |(cov, x)| wave.cycle::<C>(cov, x));
    }
}

impl Size for Growth {
    fn of<const N: usize, const M: usize>(&mut self) {
        self.form::<Conventional, N, M>("conventional");
        self.form::<Ud, N, M>("ud");
        if M == 6 {
            let wave = Wave::<Dim<N, 9, M>>::new();
            let dense = Dense::<N>::new(&wave.rows, &wave.noise, &wave.h, &wave.r);
            let cov = wave.start::<Conventional>();
            let start = SMatrix::from_fn(|i, j| cov[i][j]);
            self.bench.run(&format!("nalgebra {N} {M}"), CYCLES, || start, |p| dense.nine_rows(p));
        }
    }
}

fn main() {
    let mut growth = Growth { bench: Bench::from_arguments() };
    sizes(&mut growth);
    growth.bench.finish();
}
