//! Driving the library's views of what a log can tell.

use calib_core::Extended;
use hybrid_array::typenum::U3;
use miette::Result;
use sinscal::observability::{
    Direction, Information, Observability, Segment, Segmenter, TOLERANCE, basis, prior,
};
use sinscal::{
    Calibration, Conventional, DitherSizeEffect, Filter, FilterVisitor, Sample, Setup, Shape, Sins36P,
    Sins39P, Sins40P, Sins43P, StateInfo, Strapdown,
};

use crate::log::Log;
use crate::{output, setup};

/// Time spans over which degrees are compared, as in figure 5 of the paper.
pub(crate) const SPANS: usize = 5;
/// A combination of states whose variance the run leaves above this part of the prior's is weak: the data say less than
/// the prior does.
const WEAK: f64 = 0.5;

/// What a log can tell a filter.
pub(crate) struct Analysis {
    pub(crate) states: Vec<State>,
    pub(crate) rank: usize,
    /// Largest first.
    pub(crate) singular_values: Vec<f64>,
    /// What rounding can make of a singular value that is zero.
    pub(crate) rounding: f64,
    pub(crate) unobservable: Vec<Direction>,
    pub(crate) weak: Vec<(Direction, f64)>,
    pub(crate) segments: usize,
    pub(crate) turning: usize,
    /// Start of each span and end of the last, s.
    pub(crate) spans: [f64; SPANS + 1],
    /// Combinations with dither that the filter leaves out, and whether the log has any.
    pub(crate) confounded: Vec<Direction>,
}

/// One state.
pub(crate) struct State {
    pub(crate) info: StateInfo,
    pub(crate) spans: [f64; SPANS],
    pub(crate) degree: f64,
    pub(crate) prior_sigma: f64,
    /// At the first sample, were there no random walk.
    pub(crate) bound_sigma: f64,
    /// At the last sample, random walks included.
    pub(crate) expected_sigma: Option<f64>,
}

/// Looks at `log` with the eyes of the filter called `filter`.
pub(super) fn analyse(log: &Log, filter: &str) -> Result<Option<Analysis>> {
    let setup = setup::of(log, setup::initial(log)?);
    let samples = log.samples()?.map(|sample| Ok(sample?));
    look(filter, &setup, &log.table().display().to_string(), Box::new(samples)).transpose()
}

/// Looks at `samples`, called `name`, with the eyes of the filter called `filter`; `None` when there is no such filter.
pub(crate) fn look(
    filter: &str,
    setup: &Setup,
    name: &str,
    samples: Box<dyn Iterator<Item = Result<Sample>> + '_>,
) -> Option<Result<Analysis>> {
    sinscal::visit_filter(filter, Look { setup, name, samples })
}

struct Look<'a> {
    setup: &'a Setup<'a>,
    name: &'a str,
    samples: Box<dyn Iterator<Item = Result<Sample>> + 'a>,
}

impl FilterVisitor for Look<'_> {
    type Output = Result<Analysis>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let setup = self.setup;
        let mut run = Box::new(Calibration::<F, Conventional>::new(setup));
        let before = prior(&run);
        let mut information = Box::new(Information::new(&run));
        let mut segmenter = Segmenter::new(setup);
        let mut segments = Vec::new();
        let mut diverged = None;
        for sample in self.samples {
            let sample = sample?;
            segments.extend(segmenter.push(&sample));
            if diverged.is_none() {
                diverged = run.step_observed(&sample, information.as_mut()).err();
            }
        }
        segments.extend(segmenter.finish());
        if let Some(error) = diverged {
            output::remark(&format!("warning: {}: {error}; the sigmas to expect are left out", self.name));
        }

        let spans = boundaries(&segments);
        let mut whole = Box::new(Observability::<F>::new(setup));
        let mut degrees = Vec::new();
        for span in 0..SPANS {
            let mut part = Box::new(Observability::<F>::new(setup));
            let inside = segments.iter().filter(|segment| span_of(&spans, segment) == span);
            inside.for_each(|segment| part.add(segment));
            whole.join(&part);
            degrees.push(part.decompose());
        }
        let found = whole.decompose();
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
            segments: segments.len(),
            turning: segments.iter().filter(|segment| segment.turning).count(),
            spans,
            confounded: confounded(F::NAME, setup, &segments),
        })
    }
}

/// Start of each span and end of the last: five equal parts of the log.
fn boundaries(segments: &[Segment]) -> [f64; SPANS + 1] {
    let start = segments.first().map_or(0.0, |segment| segment.start);
    let end = segments.last().map_or(0.0, |segment| segment.start + segment.duration);
    std::array::from_fn(|i| start + (end - start) * i as f64 / SPANS as f64)
}

fn span_of(spans: &[f64; SPANS + 1], segment: &Segment) -> usize {
    let middle = segment.start + 0.5 * segment.duration;
    spans[1..SPANS].iter().filter(|boundary| middle >= **boundary).count()
}

/// What dither, where the log has it and the filter leaves it out, cannot be told apart from.
fn confounded(filter: &str, setup: &Setup, segments: &[Segment]) -> Vec<Direction> {
    if segments.iter().all(|segment| segment.signals.dither.norm() == 0.0) {
        return Vec::new();
    }
    match filter {
        "36d-p" => lost::<Extended<Sins36P, DitherSizeEffect, U3>>(setup, segments),
        "39d-p" => lost::<Extended<Sins39P, DitherSizeEffect, U3>>(setup, segments),
        "40d-p" => lost::<Extended<Sins40P, DitherSizeEffect, U3>>(setup, segments),
        "43d-p" => lost::<Extended<Sins43P, DitherSizeEffect, U3>>(setup, segments),
        _ => Vec::new(),
    }
}

fn lost<F: Filter<Dynamics = Strapdown>>(setup: &Setup, segments: &[Segment]) -> Vec<Direction> {
    let mut whole = Box::new(Observability::<F>::new(setup));
    segments.iter().for_each(|segment| whole.add(segment));
    let found = whole.decompose();
    let mut directions = basis::<F>(&found, found.rank(TOLERANCE)..F::Shape::STATES);
    directions.retain(|direction| direction.terms.iter().any(|(info, _)| info.block == "dither-size-effect"));
    directions
}
