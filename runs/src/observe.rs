//! Driving the library's views of what a log can tell.

use calib_core::{Decomposition, Extended};
use hybrid_array::typenum::U3;
use sinscal::observability::{
    Direction, Information, Observability, Segment, Segmenter, TOLERANCE, basis, prior,
};
use sinscal::{
    Calibration, Conventional, DitherSizeEffect, Diverged, Filter, Setup, Shape, Sins36P, Sins39P, Sins40P,
    Sins43P, StateInfo, Strapdown,
};

use crate::Error;
use crate::filter::AnyFilter;
use crate::samples::{Samples, each, extent};

/// Time spans over which degrees are compared, as in figure 5 of the paper.
pub const SPANS: usize = 5;
/// A combination of states whose variance the run leaves above this part of the prior's is weak: the data say less than
/// the prior does.
const WEAK: f64 = 0.5;

/// What a log can tell a filter.
pub struct Analysis {
    /// The states of the filter, in order.
    pub states: Vec<State>,
    /// Rank of the stripped observability matrix.
    pub rank: usize,
    /// Singular values, largest first.
    pub singular_values: Vec<f64>,
    /// What rounding can make of a singular value that is zero.
    pub rounding: f64,
    /// Combinations of prior sigmas that cannot be found.
    pub unobservable: Vec<Direction>,
    /// Combinations that random walks leave weak, and the part of the prior sigma that is left.
    pub weak: Vec<(Direction, f64)>,
    /// Segments of the path.
    pub segments: usize,
    /// Segments in which the unit turns.
    pub turning: usize,
    /// Start of each span and end of the last, s.
    pub spans: [f64; SPANS + 1],
    /// The filter diverged on the log: there are no sigmas to expect.
    pub diverged: Option<Diverged>,
    /// Combinations with dither that the filter leaves out, and whether the log has any.
    pub confounded: Vec<Direction>,
}

/// One state.
pub struct State {
    /// Name, component and units.
    pub info: StateInfo,
    /// Degree of observability in each span.
    pub spans: [f64; SPANS],
    /// Degree over the whole log.
    pub degree: f64,
    /// Before any reading, SI.
    pub prior_sigma: f64,
    /// Bound at the first sample, were there no random walk.
    pub bound_sigma: f64,
    /// To expect at the last sample, random walks included.
    pub expected_sigma: Option<f64>,
}

/// Looks at a log with the eyes of a filter: which combinations of its states the log shows, how well, and when.
///
/// # Errors
/// When the log cannot be read.
pub fn observe(filter: &dyn AnyFilter, samples: &dyn Samples, setup: &Setup) -> Result<Analysis, Error> {
    filter.observe(samples, setup)
}

/// [`observe`] for the filter `F`.
pub(crate) fn look<F: Filter<Dynamics = Strapdown>>(
    samples: &dyn Samples,
    setup: &Setup,
) -> Result<Analysis, Error> {
    // once for its length, so that nothing of it need be kept until the end is known
    let extent = extent(samples)?;
    let mut run = Box::new(Calibration::<F, Conventional>::new(setup));
    let before = prior(&run);
    let mut information = Box::new(Information::new(&run));
    let mut segmenter = Segmenter::new(setup);
    let mut stack = Stack::<F>::new(setup, (extent.first - 1.0 / setup.rate, extent.last));
    let mut diverged = None;
    each::<Error>(samples, |sample| {
        if let Some(segment) = segmenter.push(sample) {
            stack.add(&segment);
        }
        if diverged.is_none() {
            diverged = run.step_observed(sample, information.as_mut()).err();
        }
        Ok(())
    })?;
    if let Some(segment) = segmenter.finish() {
        stack.add(&segment);
    }

    let degrees = stack.close();
    let found = stack.whole.decompose();
    let rank = found.rank(TOLERANCE);
    let bound = information.sigmas();
    let after = prior(&run);
    let mut states = Vec::new();
    F::states(&mut |info| {
        let i = states.len();
        states.push(State {
            info,
            spans: std::array::from_fn(|span| degrees[span].degree(i)),
            degree: found.degree(i),
            prior_sigma: before[i],
            bound_sigma: bound[i],
            expected_sigma: diverged.is_none().then_some(after[i]),
        });
    });
    let ignorance = information.ignorance(&run);
    let weak = ignorance.values().iter().take_while(|part| **part > WEAK).count();
    let weak = basis::<F>(&ignorance, 0..weak)
        .into_iter()
        .zip(ignorance.values())
        .map(|(direction, part)| (direction, part.sqrt()))
        .collect();
    Ok(Analysis {
        states,
        rank,
        singular_values: found.values().to_vec(),
        rounding: found.rounding(),
        unobservable: basis::<F>(&found, rank..F::Shape::STATES),
        weak,
        segments: stack.segments,
        turning: stack.turning,
        diverged,
        spans: stack.spans,
        confounded: stack.confounded(),
    })
}

/// Takes in segments one by one: rows of the whole path, of the span they lie in, and of the filter with dither.
struct Stack<'a, F: Filter<Dynamics = Strapdown>> {
    setup: &'a Setup<'a>,
    /// Start of each span and end of the last: five equal parts of the log.
    spans: [f64; SPANS + 1],
    whole: Box<Observability<F>>,
    part: Box<Observability<F>>,
    degrees: Vec<Decomposition<F::Shape, f64>>,
    with_dither: Option<Box<dyn Rows>>,
    dithers: bool,
    segments: usize,
    turning: usize,
}

impl<'a, F: Filter<Dynamics = Strapdown>> Stack<'a, F> {
    fn new(setup: &'a Setup<'a>, (start, end): (f64, f64)) -> Self {
        Self {
            setup,
            spans: std::array::from_fn(|i| start + (end - start) * i as f64 / SPANS as f64),
            whole: Box::new(Observability::new(setup)),
            part: Box::new(Observability::new(setup)),
            degrees: Vec::new(),
            with_dither: with_dither(F::NAME, setup),
            dithers: false,
            segments: 0,
            turning: 0,
        }
    }

    fn add(&mut self, segment: &Segment) {
        let middle = segment.start + 0.5 * segment.duration;
        let span = self.spans[1..SPANS].iter().filter(|boundary| middle >= **boundary).count();
        while self.degrees.len() < span {
            self.close_span();
        }
        self.part.add(segment);
        self.segments += 1;
        self.turning += usize::from(segment.turning);
        self.dithers |= segment.signals.dither.norm() > 0.0;
        if let Some(rows) = &mut self.with_dither {
            rows.add(segment);
        }
    }

    fn close_span(&mut self) {
        self.whole.join(&self.part);
        self.degrees.push(self.part.decompose());
        *self.part = Observability::new(self.setup);
    }

    /// Ends the last span and gives what was found in each.
    fn close(&mut self) -> Vec<Decomposition<F::Shape, f64>> {
        while self.degrees.len() < SPANS {
            self.close_span();
        }
        std::mem::take(&mut self.degrees)
    }

    /// What dither, where the log has it and the filter leaves it out, cannot be told apart from.
    fn confounded(&self) -> Vec<Direction> {
        self.with_dither.as_ref().filter(|_| self.dithers).map_or(Vec::new(), |rows| rows.lost())
    }
}

/// Rows of a filter of another type.
trait Rows {
    fn add(&mut self, segment: &Segment);
    /// Combinations with dither that cannot be found.
    fn lost(&self) -> Vec<Direction>;
}

impl<F: Filter<Dynamics = Strapdown>> Rows for Observability<F> {
    fn add(&mut self, segment: &Segment) {
        Observability::add(self, segment);
    }

    fn lost(&self) -> Vec<Direction> {
        let found = self.decompose();
        let mut directions = basis::<F>(&found, found.rank(TOLERANCE)..F::Shape::STATES);
        let dither = |direction: &Direction| {
            direction.terms.iter().any(|(info, _)| info.block == "dither-size-effect")
        };
        directions.retain(dither);
        directions
    }
}

/// The filter called `filter` with the dither that it leaves out.
fn with_dither(filter: &str, setup: &Setup) -> Option<Box<dyn Rows>> {
    fn rows<F: Filter<Dynamics = Strapdown>>(setup: &Setup) -> Option<Box<dyn Rows>>
    where
        Observability<F>: 'static,
    {
        Some(Box::new(Observability::<F>::new(setup)))
    }
    match filter {
        "36d-p" => rows::<Extended<Sins36P, DitherSizeEffect, U3>>(setup),
        "39d-p" => rows::<Extended<Sins39P, DitherSizeEffect, U3>>(setup),
        "40d-p" => rows::<Extended<Sins40P, DitherSizeEffect, U3>>(setup),
        "43d-p" => rows::<Extended<Sins43P, DitherSizeEffect, U3>>(setup),
        _ => None,
    }
}
