//! A log whose reference is stamped late, as it would be with true stamps.

use core::mem;
use core::ops::ControlFlow;
use std::collections::VecDeque;

use runs::{ReadError, Samples};
use sinscal::{Reference, Sample};

/// Samples with the reference of the row that comes so many rows later; of an earlier one where that is negative. What is moved
/// off an end is lost.
#[derive(Clone, Copy)]
pub(crate) struct Shifted<'a> {
    pub(crate) samples: &'a dyn Samples,
    pub(crate) rows: i64,
}

impl Samples for Shifted<'_> {
    fn read(&self, visit: &mut dyn FnMut(&[Sample]) -> ControlFlow<()>) -> Result<(), ReadError> {
        let by = self.rows.unsigned_abs() as usize;
        let mut waiting: VecDeque<Sample> = VecDeque::with_capacity(by + 1);
        let mut readings: VecDeque<Reference> = (0..by).map(|_| Reference::default()).collect();
        let mut ready = Vec::new();
        let mut ended = false;
        self.samples.read(&mut |samples| {
            for sample in samples {
                if self.rows < 0 {
                    readings.push_back(sample.reference);
                    let reference = readings.pop_front().unwrap_or_default();
                    ready.push(Sample { reference, ..*sample });
                    continue;
                }
                waiting.push_back(*sample);
                if waiting.len() > by
                    && let Some(first) = waiting.pop_front()
                {
                    ready.push(Sample { reference: sample.reference, ..first });
                }
            }
            let going = visit(&ready);
            ready.clear();
            ended = going.is_break();
            going
        })?;
        if !ended && !waiting.is_empty() {
            let rest: Vec<Sample> = mem::take(&mut waiting)
                .into_iter()
                .map(|s| Sample { reference: Reference::default(), ..s })
                .collect();
            // whoever breaks off knows why
            let _ = visit(&rest);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn references_move_by_rows_and_samples_stay() {
        let sample = |i: i32| Sample {
            time: f64::from(i),
            dtheta: Vector3::zeros(),
            dvel: Vector3::zeros(),
            temperature: Vector3::zeros(),
            gyro_temperature: Vector3::zeros(),
            dither: Vector3::zeros(),
            reference: Reference { height: Some(f64::from(i)), ..Reference::default() },
        };
        let samples: Vec<Sample> = (0..10).map(sample).collect();
        for rows in [-3_i64, 0, 4] {
            let mut seen = Vec::new();
            let shifted = Shifted { samples: &samples, rows };
            shifted
                .read(&mut |samples| {
                    seen.extend(samples.iter().map(|s| (s.time, s.reference.height)));
                    ControlFlow::Continue(())
                })
                .unwrap();
            let expected: Vec<(f64, Option<f64>)> = (0..10_i64)
                .map(|i| (i as f64, (0..10).contains(&(i + rows)).then_some((i + rows) as f64)))
                .collect();
            assert_eq!(seen, expected, "{rows}");
        }
    }
}
