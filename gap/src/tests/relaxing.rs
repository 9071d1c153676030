//! A parameter that forgets, through the linear run, against a dense filter written from the textbook.

use nalgebra::{DMatrix, DVector};

use super::{beginning, column, step};
use crate::linear::{Noise, Recorded, run};
use crate::prices::{Prices, groups_of};
use crate::random::Stream;
use crate::recording::{CORE, Recording, Start};

/// First-order Gauss-Markov: correlation time of 20 s, stationary variance of 0.5.
const RATE: f64 = 1.0 / 20.0;
const DENSITY: f64 = 2.0 * 0.5 * RATE;
const N: usize = CORE + 2;

/// A bias that relaxes drives a velocity that is measured, beside a constant that does, and one that is priced.
fn recording() -> Recording {
    let mut stream = Stream::new(7, "tests/relaxing");
    let parameters = 3;
    let width = CORE + parameters + 1;
    let mut steps = Vec::new();
    for k in 0..60 {
        let mut step = step(k as f64, parameters, 1);
        step.elapsed = 0.5 + (k % 3) as f64;
        step.rows[3 * width + CORE] = step.elapsed;
        step.rows[3 * width + CORE + 1] = (k as f64 * 0.3).sin();
        step.rows[3 * width + CORE + 2] = (k as f64 * 0.05).cos();
        step.rows[3 * width + width - 1] = 0.1 * stream.normal();
        step.accel_noise[3 * CORE + 3] = 0.02;
        step.h[3] = 1.0;
        step.h[CORE + 1] = 0.2;
        step.r[0] = 0.04;
        step.z[0] = stream.normal();
        steps.push(step);
    }
    let columns = vec![column("mount", true), column("scale", true), column("missing", false)];
    Recording {
        columns,
        starts: vec![beginning(parameters)],
        steps,
        relaxing: vec![(0, RATE, DENSITY)],
        channels: Vec::new(),
    }
}

/// What is priced is the same in several logs, and everything else begins anew with each.
#[test]
fn several_logs_as_one_say_what_they_say_one_by_one() {
    let (mut first, mut second) = (recording(), recording());
    second.steps.truncate(40);
    second.steps.iter_mut().for_each(|step| step.z[0] += 0.3);
    first.starts[0].about = vec![0.3, -0.2, 0.1];
    second.starts[0] = Start { core: [0.5; CORE], about: vec![-0.4, 0.7, 0.2], ..second.starts[0].clone() };
    let priced = |recording: &Recording| {
        run(recording, &[0, 1], &Recorded(&[2]), &Noise::STATED, &mut |_| {}).unwrap()
    };
    let (a, b) = (priced(&first), priced(&second));
    let joined = Recording::joined(vec![first, second]).unwrap();
    let all = priced(&joined);
    assert!((all.log_likelihood - a.log_likelihood - b.log_likelihood).abs() < 1e-9);
    for (k, sum) in all.gram.iter().enumerate() {
        assert!((sum - a.gram[k] - b.gram[k]).abs() < 1e-9 * (1.0 + sum.abs()), "{k}");
    }
    assert_eq!((&all.errors, &all.variances), (&b.errors, &b.variances));
    assert_eq!(joined.about(), [-0.4, 0.7, 0.2]);
    // in the filter, what is the same in all logs gains what it is priced at, and is estimated as it is there
    let prices = Prices::new(&all.gram, vec![1.0], groups_of(&joined.columns, &[2]));
    let with = run(&joined, &[0, 1, 2], &Recorded(&[]), &Noise::STATED, &mut |_| {}).unwrap();
    assert!((with.log_likelihood - all.log_likelihood - prices.gain(&[0])).abs() < 1e-9);
    let (mean, covariance) = prices.estimates(&[0], &[1.0]).unwrap();
    assert!((joined.about()[2] - with.errors[2] - mean[0]).abs() < 1e-9);
    assert!((with.variances[2] - covariance[(0, 0)]).abs() < 1e-9);
    let lengths: Vec<usize> = joined.logs().map(<[_]>::len).collect();
    assert_eq!(lengths, [60, 40]);
    assert!(joined.steps.windows(2).all(|steps| steps[1].time > steps[0].time));
    // one in seven of each log, the first of each among them
    let kept = joined.decimated(7);
    let starts: Vec<usize> = kept.starts.iter().map(|start| start.step).collect();
    assert_eq!((kept.steps.len(), starts), (9 + 6, vec![0, 9]));
}

/// Log-likelihood, estimates and variances of the parameters; with a known value of the priced column taken out.
fn dense(recording: &Recording, missing: f64) -> (f64, [f64; 2], [f64; 2]) {
    let width = CORE + 3 + 1;
    let mut p = DMatrix::<f64>::identity(N, N);
    let mut x = DVector::<f64>::zeros(N);
    let mut log_likelihood = 0.0;
    for step in &recording.steps {
        let mut f = DMatrix::<f64>::identity(N, N);
        for i in 0..CORE {
            for j in 0..N {
                f[(i, j)] = step.rows[i * width + j];
            }
        }
        let keep = (-RATE * step.elapsed).exp();
        f[(CORE, CORE)] = keep;
        let mut known = DVector::<f64>::zeros(N);
        for i in 0..CORE {
            known[i] = step.rows[i * width + width - 1] + step.rows[i * width + CORE + 2] * missing;
        }
        x = &f * x + known;
        p = &f * p * f.transpose();
        p[(3, 3)] += 0.02;
        p[(CORE, CORE)] += 0.5 * DENSITY / RATE * (1.0 - keep * keep);
        let mut h = DVector::<f64>::zeros(N);
        for j in 0..N {
            h[j] = step.h[j];
        }
        let gain = &p * &h;
        let s = h.dot(&gain) + step.r[0];
        let innovation = step.z[0] - h.dot(&x) - step.h[CORE + 2] * missing;
        log_likelihood -= 0.5 * (innovation * innovation / s + s.ln() + std::f64::consts::TAU.ln());
        x += &gain * (innovation / s);
        p -= &gain * gain.transpose() / s;
    }
    (log_likelihood, [x[CORE], x[CORE + 1]], [p[(CORE, CORE)], p[(CORE + 1, CORE + 1)]])
}

#[test]
fn the_linear_run_is_the_filter_of_the_textbook() {
    let recording = recording();
    let found = run(&recording, &recording.base(), &Recorded(&[]), &Noise::STATED, &mut |_| {}).unwrap();
    let (log_likelihood, estimates, variances) = dense(&recording, 0.0);
    assert!(
        (found.log_likelihood - log_likelihood).abs() < 1e-9,
        "{} {log_likelihood}",
        found.log_likelihood
    );
    for i in 0..2 {
        assert!((found.errors[i] + estimates[i]).abs() < 1e-10, "{:?} {estimates:?}", found.errors);
        assert!((found.variances[i] - variances[i]).abs() < 1e-10);
    }
}

/// The score and the information of a priced column are the first and second differences of the log-likelihood by its value.
#[test]
fn prices_beside_a_relaxing_parameter_are_derivatives() {
    let recording = recording();
    let found = run(&recording, &recording.base(), &Recorded(&[2]), &Noise::STATED, &mut |_| {}).unwrap();
    let at = |value: f64| dense(&recording, value).0;
    let (up, down, here) = (at(1.0), at(-1.0), at(0.0));
    let (score, information) = (0.5 * (up - down), 2.0 * here - up - down);
    assert!(
        (found.gram[1].abs() - score.abs()).abs() < 1e-8 * score.abs().max(1.0),
        "{} {score}",
        found.gram[1]
    );
    assert!((found.gram[3] - information).abs() < 1e-8 * information, "{} {information}", found.gram[3]);
}
