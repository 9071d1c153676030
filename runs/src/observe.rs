//! Driving the library's views of what a log can tell.

use calib_core::{Block as _, Decomposition};
use sinscal::observability::{
    Direction, Information, Observability, Segment, Segmenter, TOLERANCE, basis, prior,
};
use sinscal::{
    AnyEffect, Calibration, Conventional, DitherSizeEffect, Diverged, Filter, Reference, Setup, Shape,
    StateInfo, Strapdown,
};

use crate::Error;
use crate::compiled::{Selection, boxed, own};
use crate::compose::Composition;
use crate::filter::AnyFilter;
use crate::samples::{Extent, Samples, each};

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
    /// Whether the log tells any dither.
    pub dithers: bool,
    /// Combinations with the dither's size effect that cannot be told apart, where the filter leaves it out and the log has it.
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
    let mut analysis = filter.observe(samples, setup)?;
    if analysis.dithers
        && !filter.needs_dither()
        && let Ok(with_dither) =
            Composition::with_states_for(filter, &[<dyn AnyEffect>::of::<DitherSizeEffect>()])
    {
        let dither = |direction: &Direction| {
            direction.terms.iter().any(|(info, _)| info.block == DitherSizeEffect::NAME)
        };
        let with_dither: &dyn AnyFilter = &with_dither;
        analysis.confounded = with_dither.observe(samples, setup)?.unobservable;
        analysis.confounded.retain(dither);
    }
    Ok(analysis)
}

/// [`observe`] for the filter `F`.
pub(crate) fn look<F: Filter<Dynamics = Strapdown>>(
    samples: &dyn Samples,
    setup: &Setup,
    selection: &Selection,
) -> Result<Analysis, Error> {
    let setup = &Setup { open: selection.open, ..*setup };
    // once for its length and what is read of the reference, so that nothing of it need be kept until the end is known
    let mut extent = Extent::default();
    let mut read = vec![false; F::MEASURES.len()];
    each::<Error>(samples, |sample| {
        extent.push(sample.time);
        let here = F::MEASURES.iter().map(|info| is_read(info.name, &sample.reference));
        read.iter_mut().zip(here).for_each(|(read, here)| *read |= here);
        Ok(())
    })?;
    let unread: Vec<usize> = (0..read.len()).filter(|measured| !read[*measured]).collect();
    if unread.len() == read.len() {
        let measures = F::MEASURES.iter().map(|info| info.name).collect::<Vec<_>>().join(" and ");
        return Err(Error::NoUpdate { filter: F::NAME.to_owned(), measures });
    }
    let mut run = boxed(|| Calibration::<F, Conventional>::with_prior(setup, |_, _, sigma| sigma));
    let before = prior(&run);
    let mut information = boxed(|| Information::new(&run));
    let mut segmenter = Segmenter::new(setup);
    let mut stack = Stack::<F>::new(setup, unread, (extent.first - 1.0 / setup.rate, extent.last), selection);
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
    let found = boxed(|| stack.whole.decompose());
    let held = |value: &usize| stack.held.iter().any(|state| found.direction(*value)[*state].abs() > 0.5);
    let shown: Vec<usize> = (0..F::Shape::STATES).filter(|value| !held(value)).collect();
    let bound = information.sigmas();
    let after = prior(&run);
    let mut infos = Vec::with_capacity(F::Shape::STATES);
    selection.open.states_of::<F>(&mut |info| infos.push(info));
    let state = |i: usize| State {
        info: infos[i],
        spans: std::array::from_fn(|span| degrees[span].degree(i)),
        degree: found.degree(i),
        prior_sigma: before[i],
        bound_sigma: bound[i],
        expected_sigma: diverged.is_none().then_some(after[i]),
    };
    let mut declared = Vec::with_capacity(F::Shape::STATES);
    F::states(&mut |info| declared.push(info));
    // what joined at run time has names of its own
    let named = |mut direction: Direction| {
        for (info, _) in &mut direction.terms {
            let same = |other: &StateInfo| (other.block, other.component) == (info.block, info.component);
            *info = declared.iter().position(same).map_or(*info, |i| infos[i]);
        }
        direction
    };
    let basis = |found, which| basis::<F>(found, which).into_iter().map(named).collect::<Vec<_>>();
    let ignorance = boxed(|| information.ignorance(&run));
    let weak = ignorance.values().iter().take_while(|part| **part > WEAK).count();
    let weak = basis(&ignorance, 0..weak)
        .into_iter()
        .zip(ignorance.values())
        .map(|(direction, part)| (direction, part.sqrt()))
        .collect();
    Ok(Analysis {
        states: (0..F::Shape::CORE).chain(selection.states.iter().copied()).map(state).collect(),
        rank: shown.iter().filter(|value| found.values()[**value] > TOLERANCE).count(),
        singular_values: shown.iter().map(|value| found.values()[*value]).collect(),
        rounding: found.rounding(),
        unobservable: basis(&found, found.rank(TOLERANCE)..F::Shape::STATES),
        weak,
        segments: stack.segments,
        turning: stack.turning,
        diverged,
        dithers: stack.dithers,
        spans: stack.spans,
        confounded: Vec::new(),
    })
}

/// Whether a reference holds a reading of a measurement, by its name.
fn is_read(measurement: &str, reference: &Reference) -> bool {
    match measurement {
        "velocity" => reference.velocity.is_some(),
        "position" => reference.position.is_some(),
        "attitude" => reference.attitude.is_some(),
        "rate" => reference.rate.is_some(),
        "height" => reference.height.is_some(),
        "heading" => reference.heading.is_some(),
        _ => reference.own.iter().any(|value| !value.is_nan()),
    }
}

/// Rows of a filter that cannot see what is never read.
fn nothing_seen<F: Filter<Dynamics = Strapdown>>(setup: &Setup, unread: &[usize]) -> Observability<F> {
    unread.iter().fold(Observability::new(setup), |rows, measured| rows.unread(*measured))
}

/// Takes in segments one by one: rows of the whole path, of the span they lie in, and of the filter with dither.
struct Stack<'a, F: Filter<Dynamics = Strapdown>> {
    setup: &'a Setup<'a>,
    /// Measurements that the log has no reading of.
    unread: Vec<usize>,
    /// Start of each span and end of the last: five equal parts of the log.
    spans: [f64; SPANS + 1],
    whole: Box<Observability<F>>,
    part: Box<Observability<F>>,
    degrees: Vec<Box<Decomposition<F::Shape, f64>>>,
    /// States that take no part.
    held: Vec<usize>,
    dithers: bool,
    segments: usize,
    turning: usize,
}

impl<'a, F: Filter<Dynamics = Strapdown>> Stack<'a, F> {
    fn new(
        setup: &'a Setup<'a>,
        unread: Vec<usize>,
        (start, end): (f64, f64),
        selection: &Selection,
    ) -> Self {
        let held = own::<F>().filter(|state| selection.place(*state).is_none()).collect();
        let mut stack = Self {
            setup,
            spans: std::array::from_fn(|i| start + (end - start) * i as f64 / SPANS as f64),
            whole: boxed(|| nothing_seen(setup, &unread)),
            part: boxed(|| nothing_seen(setup, &unread)),
            unread,
            degrees: Vec::new(),
            held,
            dithers: false,
            segments: 0,
            turning: 0,
        };
        stack.held.iter().for_each(|state| stack.whole.know(*state));
        stack
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
    }

    fn close_span(&mut self) {
        self.whole.join(&self.part);
        self.degrees.push(boxed(|| self.part.decompose()));
        self.part = boxed(|| nothing_seen(self.setup, &self.unread));
    }

    /// Ends the last span and gives what was found in each.
    fn close(&mut self) -> Vec<Box<Decomposition<F::Shape, f64>>> {
        while self.degrees.len() < SPANS {
            self.close_span();
        }
        std::mem::take(&mut self.degrees)
    }
}
