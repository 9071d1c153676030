//! Laws priced beside a set of effects: what resembles a known effect, and what is in no library.

use nalgebra::{DMatrix, DVector};
use sinscal::{Kind, Law};

use crate::dictionary::{Dictionary, SIZE, Triad, along};
use crate::linear::run;
use crate::prices::{Group, Prices};
use crate::scene::Scene;

/// A term that is smaller than this, SI, does not show.
const LEAST: f64 = 1e-30;

/// A law of one triad, in units of its root mean square on the first log that it was priced on.
#[derive(Clone, Debug)]
pub(crate) struct Neighbour {
    pub(crate) law: Law,
    triad: &'static str,
    rms: [f64; 3],
}

impl Neighbour {
    pub(crate) fn is_gyro(&self) -> bool {
        self.law.kind() == Kind::Rate
    }

    /// Coefficients in that unit, from values in units of the root mean square.
    pub(crate) fn coefficients<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        values.iter().zip(&self.rms).map(|(value, rms)| value / rms)
    }
}

/// Score and information of neighbours, each by itself and with a set of known effects.
pub(crate) struct Neighbours {
    pub(crate) all: Vec<Neighbour>,
    /// Those of the set alone.
    known: Prices,
    /// For each neighbour: score, own information, and that shared with the set.
    own: Vec<(DVector<f64>, DMatrix<f64>, DMatrix<f64>)>,
    sigma: Vec<f64>,
}

impl Neighbours {
    /// All laws of triads of these names that show in a log at all.
    pub(crate) fn of(scene: &Scene, set: &[usize], triads: &[&str]) -> Option<Self> {
        let is_asked = |triad: &Triad| triads.contains(&triad.name);
        let triads: Vec<Triad> = Triad::all(&scene.ran.recording).into_iter().filter(is_asked).collect();
        let mut values = Vec::new();
        let mut all = Vec::new();
        for triad in &triads {
            for law in Law::all(triad.name == "gyro") {
                if let Some((neighbour, columns)) = seen(scene, triad, law) {
                    all.push(neighbour);
                    values.extend(columns);
                }
            }
        }
        Self::priced(scene, set, &triads, all, values)
    }

    /// The same laws in the same units on another log.
    pub(crate) fn again(&self, scene: &Scene, set: &[usize]) -> Option<Self> {
        let triads = Triad::all(&scene.ran.recording);
        let values = self.all.iter().flat_map(|neighbour| {
            (0..3).map(|i| {
                let mut value = along(&scene.ran.recording, |moment| {
                    neighbour.law.value(moment.motion, i) / neighbour.rms[i]
                });
                // what is not read there shows nothing there
                value.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
                value
            })
        });
        Self::priced(scene, set, &triads, self.all.clone(), values.collect())
    }

    fn priced(
        scene: &Scene,
        set: &[usize],
        triads: &[Triad],
        all: Vec<Neighbour>,
        values: Vec<Vec<f64>>,
    ) -> Option<Self> {
        let recording = &scene.ran.recording;
        let library = scene.columns(set);
        let mut dictionary = Dictionary::new(&library);
        dictionary.is_summed = false;
        for (at, value) in values.into_iter().enumerate() {
            let neighbour: &Neighbour = &all[at / 3];
            let column = triads.iter().find(|triad| triad.name == neighbour.triad)?.columns[at % 3];
            dictionary.push(column, value, SIZE * recording.columns[column].prior, 1.0);
        }
        let (n, m) = (dictionary.own(), library.len());
        // e and the set with everything, and each neighbour with itself
        let mut shared = vec![vec![0.0; n + m]; 1 + m];
        let mut own = vec![[0.0; 9]; n / 3];
        run(recording, &recording.base(), &dictionary, &scene.noise, &mut |whitened| {
            for row in whitened.rows.chunks_exact(1 + n + m) {
                let (e, columns) = (row[0], &row[1..]);
                for (sums, by) in shared.iter_mut().zip(core::iter::once(&e).chain(&columns[n..])) {
                    sums.iter_mut().zip(columns).for_each(|(sum, column)| *sum += by * column);
                }
                for (sums, columns) in own.iter_mut().zip(columns.chunks_exact(3)) {
                    for i in 0..3 {
                        (0..3).for_each(|j| sums[3 * i + j] += columns[i] * columns[j]);
                    }
                }
            }
        })?;
        let sigma = dictionary.sigma;
        let mut known = scene.prices.only(set);
        let of_set = known.sigma.clone();
        // the noise of both runs is the same, and so are the sums
        known.b = DVector::from_fn(m, |i, _| shared[0][n + i] * of_set[i]);
        let own = own.iter().enumerate().map(|(g, sums)| {
            let first = 3 * g;
            (
                DVector::from_fn(3, |i, _| shared[0][first + i] * sigma[first + i]),
                DMatrix::from_fn(3, 3, |i, j| sums[3 * i + j] * sigma[first + i] * sigma[first + j]),
                DMatrix::from_fn(3, m, |i, j| shared[1 + j][first + i] * sigma[first + i] * of_set[j]),
            )
        });
        Some(Self { own: own.collect(), all, known, sigma })
    }

    /// Prices of the set and, after it, one neighbour.
    pub(crate) fn with(&self, at: usize) -> Prices {
        let (score, information, with_set) = &self.own[at];
        let m = self.known.sigma.len();
        let mut b = DVector::zeros(m + 3);
        b.rows_mut(0, m).copy_from(&self.known.b);
        b.rows_mut(m, 3).copy_from(score);
        let mut lambda = DMatrix::zeros(m + 3, m + 3);
        lambda.view_mut((0, 0), (m, m)).copy_from(&self.known.lambda);
        lambda.view_mut((m, m), (3, 3)).copy_from(information);
        lambda.view_mut((m, 0), (3, m)).copy_from(with_set);
        lambda.view_mut((0, m), (m, 3)).copy_from(&with_set.transpose());
        let mut sigma = self.known.sigma.clone();
        sigma.extend_from_slice(&self.sigma[3 * at..3 * at + 3]);
        let mut groups = self.known.groups.clone();
        groups.push(Group { name: self.all[at].law.name(), members: (m..m + 3).collect() });
        Prices { b, lambda, sigma, groups }
    }
}

/// A law that shows in a log, with its values.
fn seen(scene: &Scene, triad: &Triad, law: Law) -> Option<(Neighbour, Vec<Vec<f64>>)> {
    let mut neighbour = Neighbour { law, triad: triad.name, rms: [0.0; 3] };
    let mut columns = Vec::new();
    for i in 0..3 {
        let mut value = along(&scene.ran.recording, |moment| neighbour.law.value(moment.motion, i));
        let rms = (value.iter().map(|v| v * v).sum::<f64>() / value.len().max(1) as f64).sqrt();
        if rms.is_nan() || rms < LEAST {
            return None;
        }
        value.iter_mut().for_each(|v| *v /= rms);
        neighbour.rms[i] = rms;
        columns.push(value);
    }
    Some((neighbour, columns))
}
