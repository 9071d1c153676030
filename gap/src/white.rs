//! Whether what is left looks like noise: the Ljung-Box test of the whitened innovations.

use crate::chi2::ln_survival;
use crate::linear::{Recorded, run};
use crate::report::Whiteness;
use crate::scene::Scene;

/// Autocorrelations that are tested.
const LAGS: usize = 10;

/// The whitened innovations of a scene, without and with the groups `named` at what the log says of them.
pub(crate) fn whiteness(scene: &Scene, named: &[usize]) -> Option<Whiteness> {
    let recording = &scene.ran.recording;
    let columns = scene.columns(named);
    let mean =
        if named.is_empty() { Vec::new() } else { scene.prices.posterior(named)?.0.as_slice().to_vec() };
    let nc = 1 + columns.len();
    let mut before = vec![Vec::new(); recording.channels.len()];
    let mut after = vec![Vec::new(); recording.channels.len()];
    run(recording, &recording.base(), &Recorded(&columns), &scene.noise, &mut |whitened| {
        for (row, channel) in whitened.rows.chunks_exact(nc).zip(&whitened.step.channel) {
            let shown: f64 = row[1..].iter().zip(&mean).map(|(s, m)| s * m).sum();
            before[*channel].push(row[0]);
            after[*channel].push(row[0] - shown);
        }
    })?;
    Some(Whiteness {
        lags: LAGS,
        log10_p_before: ljung_box(&before) / core::f64::consts::LN_10,
        log10_p_after: ljung_box(&after) / core::f64::consts::LN_10,
    })
}

/// Natural logarithm of the p-value of all series together (Ljung and Box, Biometrika 65, 1978).
fn ljung_box(series: &[Vec<f64>]) -> f64 {
    let (mut q, mut degrees) = (0.0, 0);
    for x in series.iter().filter(|x| x.len() > 10 * LAGS) {
        let n = x.len() as f64;
        let power: f64 = x.iter().map(|v| v * v).sum();
        for lag in 1..=LAGS {
            let r = x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / power;
            q += n * (n + 2.0) * r * r / (n - lag as f64);
            degrees += 1;
        }
    }
    if degrees == 0 { 0.0 } else { ln_survival(q, degrees) }
}

#[cfg(test)]
mod tests {
    use super::ljung_box;
    use crate::random::Stream;

    #[test]
    fn white_series_pass_and_coloured_ones_do_not() {
        let mut stream = Stream::new(1, "white");
        let white: Vec<f64> = (0..2000).map(|_| stream.normal()).collect();
        assert!(ljung_box(core::slice::from_ref(&white)) > -5.0);
        let coloured: Vec<f64> = white.windows(2).map(|w| w[1] + 0.4 * w[0]).collect();
        assert!(ljung_box(&[coloured]) < -50.0);
    }

    #[test]
    fn p_values_of_white_series_are_uniform() {
        let mut stream = Stream::new(2, "white");
        let small = (0..400)
            .filter(|_| {
                let series: Vec<Vec<f64>> =
                    (0..3).map(|_| (0..300).map(|_| stream.normal()).collect()).collect();
                ljung_box(&series) < 0.1_f64.ln()
            })
            .count();
        // 40 expected, standard deviation 6
        assert!((20..=60).contains(&small), "{small}");
    }
}
