//! How each parameter's estimate came about, in memory that does not grow with the log.

/// More points are thinned out: every second one is dropped and twice as many updates pass between two.
const CAPACITY: usize = 2048;
/// A parameter has converged once its sigma stays within this factor of the final one.
const CONVERGED: f64 = 2.0;

/// Estimates and sigmas over time, at evenly thinned updates.
#[derive(Clone, Debug)]
pub struct History {
    width: usize,
    /// Least time between points, s.
    step: f64,
    stride: usize,
    updates: usize,
    times: Vec<f64>,
    /// `width` pairs of value and sigma for each time.
    points: Vec<(f64, f64)>,
}

impl History {
    /// An empty history of `width` parameters with points at least `step` apart, s.
    pub fn new(width: usize, step: f64) -> Self {
        Self { width, step, stride: 1, updates: 0, times: Vec::new(), points: Vec::new() }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::new(self.width, self.step);
    }

    /// Counts an update at `time` and tells whether its point is wanted.
    pub fn due(&mut self, time: f64) -> bool {
        if self.times.last().is_some_and(|last| time < last + self.step) {
            return false;
        }
        let due = self.updates.is_multiple_of(self.stride);
        self.updates += 1;
        due
    }

    /// Keeps a point: value and sigma of each parameter.
    pub fn push(&mut self, time: f64, parameters: impl Iterator<Item = (f64, f64)>) {
        if self.times.last() == Some(&time) {
            return;
        }
        let start = self.points.len();
        self.points.extend(parameters);
        self.points.resize(start + self.width, (f64::NAN, f64::NAN));
        self.times.push(time);
        if self.times.len() == CAPACITY {
            self.thin();
        }
    }

    fn thin(&mut self) {
        let kept = self.times.len().div_ceil(2);
        for index in 0..kept {
            self.times[index] = self.times[2 * index];
            let from = 2 * index * self.width;
            self.points.copy_within(from..from + self.width, index * self.width);
        }
        self.times.truncate(kept);
        self.points.truncate(kept * self.width);
        self.stride *= 2;
    }

    /// Time since `start` after which the sigma of a parameter stays within twice its final value.
    pub fn converged(&self, parameter: usize, start: f64) -> Option<f64> {
        let sigmas = self.points.iter().skip(parameter).step_by(self.width.max(1)).map(|(_, sigma)| *sigma);
        let sigmas: Vec<f64> = sigmas.collect();
        let last = *sigmas.last()?;
        let unsettled = sigmas.iter().rposition(|sigma| sigma.is_nan() || *sigma > CONVERGED * last);
        let first = unsettled.map_or(0, |index| index + 1);
        self.times.get(first).map(|time| time - start)
    }

    /// The least and the largest value of a parameter since it converged.
    pub fn range(&self, parameter: usize, start: f64) -> Option<(f64, f64)> {
        let since = self.converged(parameter, start)? + start;
        let values = self.rows().filter(|(time, _)| *time >= since).map(|(_, points)| points[parameter].0);
        let range = |(least, most): (f64, f64), value: f64| (least.min(value), most.max(value));
        Some(values.fold((f64::INFINITY, f64::NEG_INFINITY), range))
    }

    /// Times with the values and sigmas kept for them.
    pub fn rows(&self) -> impl Iterator<Item = (f64, &[(f64, f64)])> {
        self.times.iter().copied().zip(self.points.chunks(self.width.max(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_bounded_and_the_span_is_covered() {
        let mut history = History::new(2, 0.0);
        for update in 0..100_000 {
            let time = f64::from(update);
            if history.due(time) {
                let sigma = if update < 40_000 { 10.0 } else { 1.0 };
                history.push(time, [(time, 1.0), (-time, sigma)].into_iter());
            }
        }
        history.push(99_999.0, [(99_999.0, 1.0), (-99_999.0, 1.0)].into_iter());
        assert!(history.times.len() <= CAPACITY);
        assert!(history.times.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(history.converged(0, 0.0), Some(0.0));
        assert_eq!(history.range(0, 0.0), Some((0.0, 99_999.0)));
        assert!(history.range(1, 0.0).is_some_and(|(least, most)| least == -99_999.0 && most < -39_999.0));
        assert!(history.converged(1, 0.0).is_some_and(|time| (40_000.0..40_200.0).contains(&time)));
        assert!(history.rows().all(|(time, point)| point[0].0 == time && point[1].0 == -time));
    }
}
