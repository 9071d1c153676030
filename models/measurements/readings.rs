//! Where the measurements of a filter find their readings in a sample.

use calib_core::{Array, Filter, MeasurementInfo, MeasurementVector};

use crate::Strapdown;
use crate::gate::MOST;
use crate::sample::{OWN, Reference};
use crate::setup::Setup;

/// Columns of a log that a reference has fields for, in the order of `Reference::value`.
pub(crate) const KNOWN: [&str; 15] = [
    "ref_vel_e",
    "ref_vel_n",
    "ref_vel_u",
    "ref_pos_e",
    "ref_pos_n",
    "ref_pos_u",
    "ref_quat_w",
    "ref_quat_x",
    "ref_quat_y",
    "ref_quat_z",
    "ref_rate_x",
    "ref_rate_y",
    "ref_rate_z",
    "ref_height",
    "ref_heading",
];

/// The columns that [`Reference::own`] holds for a filter that measures `measures`, in their order: those that a reference has no
/// field for, each once.
pub(crate) const fn own_columns(measures: &[MeasurementInfo]) -> ([&'static str; OWN], usize) {
    let mut own = [""; OWN];
    let mut count = 0;
    let mut k = 0;
    while k < measures.len() {
        let columns = measures[k].columns;
        let mut i = 0;
        while i < columns.len() {
            if find(&KNOWN, columns[i]).is_none() && find(own.split_at(count).0, columns[i]).is_none() {
                assert!(count < OWN, "the measurements of a filter read too many columns of their own");
                own[count] = columns[i];
                count += 1;
            }
            i += 1;
        }
        k += 1;
    }
    (own, count)
}

const fn find(names: &[&str], name: &str) -> Option<usize> {
    let mut k = 0;
    while k < names.len() {
        let (a, b) = (names[k].as_bytes(), name.as_bytes());
        let mut same = a.len() == b.len();
        let mut i = 0;
        while same && i < a.len() {
            same = a[i] == b[i];
            i += 1;
        }
        if same {
            return Some(k);
        }
        k += 1;
    }
    None
}

/// Where a measurement's reading is, and how good one is that does not say.
#[derive(Clone, Copy, Debug)]
struct Source {
    slots: [usize; OWN],
    sigma: f64,
}

/// Takes readings of the measurements of filter `F` out of samples.
pub(crate) struct Readings<F: Filter<Dynamics = Strapdown>> {
    sources: MeasurementVector<F, Source>,
}

/// Numbers of a reading, in the order of the measurement's columns; zero behind them.
pub(crate) type Reading = [f64; OWN];

impl<F: Filter<Dynamics = Strapdown>> Readings<F> {
    pub(crate) fn new(setup: &Setup) -> Self {
        let (own, count) = const {
            assert!(F::MEASURES.len() <= MOST, "a filter measures too many things");
            let mut k = 0;
            while k < F::MEASURES.len() {
                assert!(F::MEASURES[k].columns.len() <= OWN, "a measurement reads too many columns");
                k += 1;
            }
            own_columns(F::MEASURES)
        };
        let mut sources: MeasurementVector<F, Source> =
            Array::from_fn(|| Source { slots: [usize::MAX; OWN], sigma: f64::NAN });
        for (k, info) in F::MEASURES.iter().enumerate() {
            for (slot, column) in sources[k].slots.iter_mut().zip(info.columns) {
                let known = find(&KNOWN, column);
                let own = || find(&own[..count], column).map(|k| KNOWN.len() + k);
                *slot = known.or_else(own).unwrap_or(usize::MAX);
            }
            sources[k].sigma = setup.sigma(info);
        }
        Self { sources }
    }

    /// The reading of a measurement by its place; `None` without one.
    pub(crate) fn read(&self, measured: usize, reference: &Reference) -> Option<Reading> {
        let mut reading = [0.0; OWN];
        for (value, slot) in reading.iter_mut().zip(self.slots(measured)) {
            *value = reference.value(*slot)?;
        }
        (!self.slots(measured).is_empty()).then_some(reading)
    }

    /// Standard deviation of a row of a measurement, both by their place.
    pub(crate) fn sigma(&self, measured: usize, row: usize, reference: &Reference) -> f64 {
        let stated = self.slots(measured).get(row).map_or(f64::NAN, |slot| reference.stated_sigma(*slot));
        if stated.is_nan() { self.sources[measured].sigma } else { stated }
    }

    fn slots(&self, measured: usize) -> &[usize] {
        &self.sources[measured].slots[..F::MEASURES[measured].columns.len()]
    }
}
