//! What `benches/instructions.sh`, `benches/stack.sh` and `benches/report` count: one thing, so many times.

#[path = "../../case/mod.rs"]
mod case;
#[path = "../../case/navigation.rs"]
mod navigation;
#[path = "../../case/wave.rs"]
mod wave;

use std::hint::black_box;
use std::process::ExitCode;

use calib_core::{Conventional, Dim, Form, Ud};
use case::{Case, N, case, cycle, factors};
use navigation::Navigation;
use wave::{Size, Wave, sizes};

/// Cycles of one form, one after the other.
fn cycles<C: Form>(case: &Case, mut p: [[f64; N]; N], times: u32) -> f64 {
    (0..times).map(|_| cycle::<C>(case, black_box(&mut p))).sum()
}

/// Cycles of a filter of the size that is wanted.
struct Grown<'a> {
    form: &'a str,
    /// States and measurements.
    wanted: [usize; 2],
    times: u32,
    /// `None` where that size or form was not foreseen.
    found: Option<f64>,
}

impl Grown<'_> {
    fn cycles<C: Form, const N: usize, const M: usize>(&self) -> f64 {
        let wave = Wave::<Dim<N, 9, M>>::new();
        let (mut cov, mut x) = (wave.start::<C>(), [0.0; N]);
        (0..self.times).map(|_| wave.cycle::<C>(black_box(&mut cov), &mut x)).sum()
    }
}

impl Size for Grown<'_> {
    fn of<const N: usize, const M: usize>(&mut self) {
        if self.wanted == [N, M] {
            self.found = match self.form {
                "conventional" => Some(self.cycles::<Conventional, N, M>()),
                "ud" => Some(self.cycles::<Ud, N, M>()),
                _ => None,
            };
        }
    }
}

/// Samples of navigation; how many of them went well.
fn navigate(times: u32) -> f64 {
    let mut navigation = Navigation::new();
    (0..times).map(|_| f64::from(u8::from(black_box(&mut navigation).step()))).sum()
}

/// `what` so many times; `None` where there is no such thing.
fn run(what: &str, times: u32) -> Option<f64> {
    let case = case();
    match what.split(':').collect::<Vec<_>>()[..] {
        ["conventional"] => Some(cycles::<Conventional>(&case, case.p, times)),
        ["ud"] => Some(cycles::<Ud>(&case, factors(&case.p), times)),
        ["navigation"] => Some(navigate(times)),
        [form, states, measurements] => {
            let wanted = [states.parse().ok()?, measurements.parse().ok()?];
            let mut grown = Grown { form, wanted, times, found: None };
            sizes(&mut grown);
            grown.found
        }
        _ => None,
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, times] = arguments.as_slice() else {
        eprintln!("what (conventional, ud, navigation, ud:STATES:MEASUREMENTS, ...) and how many times");
        return ExitCode::from(2);
    };
    let Ok(times) = times.parse() else { return ExitCode::from(2) };
    let Some(found) = run(what, times) else {
        eprintln!("no such thing: {what}");
        return ExitCode::from(2);
    };
    println!("{found}");
    ExitCode::SUCCESS
}
