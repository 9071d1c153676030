//! What stands for readings of a reference where nobody has measured anything: a fixed point, or the rests of the unit.

use std::sync::Arc;

use nalgebra::Vector3;
use sinscal::{Missed, Reference, ReferenceSigma, Sample, UnknownPulses, earth};

use super::columns::Group;
use super::description::ReferenceKind;
use super::fault::LogError;
use super::grade::Grade;
use super::look::{Channels, Contradiction, contradictions};
use super::rests::{Rest, RestFinder, Rests};
use super::units::{DEG_PER_SQRT_HOUR, DEGREE, MICRO_G};
use super::{Log, MEASURED_RATE, NO_NOISE};

const DEG_PER_HOUR: f64 = DEGREE / 3600.0;

/// What the increments of a turn by hand miss: they close to 0.1 to 0.5 m/s, and to 0.05 deg and some thousandth of the angle.
const MISSED_VELOCITY: f64 = 1.0;
const MISSED_ATTITUDE: f64 = 0.05 * DEGREE;
const MISSED_OF_ANGLE: f64 = 1e-3;
/// Without a reading for so long, s, and not at rest all the while, the unit was moved.
const APART: f64 = 0.3;
/// At both ends of a rest so much is left out, s: there it begins and ends.
const EDGE: f64 = 0.2;
/// A heading known no better than this leaves the Earth's rate open, rad.
const HEADING: f64 = 10.0 * DEGREE;
/// Gyro biases of the MEMS class differ by this from rest to rest, rad/s, where there are too few rests to measure it, and are never
/// known to differ by less than that.
const WANDER: f64 = 20.0 * DEG_PER_HOUR;
const LEAST_WANDER: f64 = 2.0 * DEG_PER_HOUR;
/// Fewer rests than this show no scatter.
const FEWEST: usize = 4;
/// Rests that scatter by so many times the stated noise deserve a word, and by so many a refusal.
const NOISIER: f64 = 10.0;
const ABSURD: f64 = 100.0;
/// The least that are taken for a noise, rad/sqrt(s) and m/s/sqrt(s).
const LEAST_NOISE: [f64; 2] = [1e-4 * DEG_PER_SQRT_HOUR, 0.1 * MICRO_G];
/// What takes the place of the columns, or joins them.
#[derive(Clone, Debug)]
pub(super) enum Instead {
    /// A point that does not move.
    FixedPoint,
    /// The rests of the unit.
    Rests(Arc<AtRest>),
}

/// The rests of a unit as readings: there its velocity is zero, and its rate.
#[derive(Debug)]
pub(super) struct AtRest {
    /// In order, without their ends.
    rests: Vec<Rest>,
    /// Standard deviation of a reading of the rate in each, rad/s.
    sigmas: Vec<f64>,
    /// Rows before this one are not used.
    first_row: u64,
    /// Whether readings of the columns stay.
    columns: bool,
}

/// Gives samples what stands for a reference, row by row.
#[derive(Clone, Debug)]
pub(super) struct Referee {
    instead: Instead,
    row: u64,
    /// Time of the last reading, whether the unit was at rest ever since, and how far it has turned.
    read: Option<f64>,
    rested: bool,
    turned: f64,
}

impl Referee {
    pub(super) fn new(instead: Instead) -> Self {
        Self { instead, row: 0, read: None, rested: true, turned: 0.0 }
    }

    /// Takes in the next sample; `false` when it is not used.
    pub(super) fn refer(&mut self, sample: &mut Sample) -> bool {
        self.row += 1;
        let at_rest = match &self.instead {
            Instead::FixedPoint => {
                let zero = Some(Vector3::zeros());
                sample.reference = Reference { velocity: zero, position: zero, ..Reference::default() };
                return true;
            }
            Instead::Rests(at_rest) => at_rest,
        };
        if self.row < at_rest.first_row {
            return false;
        }
        if !at_rest.columns {
            sample.reference = Reference::default();
        }
        let sigma = at_rest.rate_sigma(self.row);
        if let Some(sigma) = sigma {
            sample.reference.velocity = Some(Vector3::zeros());
            sample.reference.rate = Some(Vector3::zeros());
            sample.reference.sigma.rate = Vector3::repeat(sigma);
        }
        self.rested &= sigma.is_some();
        self.turned += sample.dtheta.norm();
        if sample.reference.velocity.is_some() {
            if !self.rested && self.read.is_none_or(|read| sample.time - read > APART) {
                let attitude = MISSED_ATTITUDE + MISSED_OF_ANGLE * self.turned;
                sample.reference.missed = Missed { attitude, velocity: MISSED_VELOCITY };
            }
            (self.read, self.rested, self.turned) = (Some(sample.time), true, 0.0);
        }
        true
    }
}

impl AtRest {
    /// How well the rate is known in a row, rad/s; nothing between rests.
    fn rate_sigma(&self, row: u64) -> Option<f64> {
        let at = self.rests.partition_point(|rest| rest.last_row < row);
        self.rests.get(at).filter(|rest| rest.first_row <= row)?;
        self.sigmas.get(at).copied()
    }
}

/// What the columns hold.
#[derive(Default)]
struct Columns {
    /// A reading that is not a velocity of zero.
    moves: bool,
    /// Readings, and rows without one.
    readings: u64,
    empty: u64,
    /// What is odd about gyros and accelerometers.
    warnings: Vec<String>,
}

impl Log {
    /// Decides what stands for readings of a reference where a filter measures `measures` and the table holds none: the rests of a
    /// hand-carried unit, whose filter measures velocity and rate alone; else a fixed point. `reference.kind` of the description goes
    /// before. Where the columns of a hand-carried unit hold nothing but the zero velocity of its rests, what else a rest says joins
    /// them.
    ///
    /// # Errors
    /// When the log cannot be read, nothing can stand for what the filter measures, or the unit does not rest.
    pub fn refer(&mut self, measures: &[&str]) -> Result<(), LogError> {
        let has = |name| measures.contains(&name);
        let carried = has("velocity") && has("rate") && !has("position");
        let is_read =
            |group| self.table.has(group) || self.reference.as_ref().is_some_and(|apart| apart.has(group));
        let velocity_alone = is_read(Group::REF_VEL)
            && ![Group::REF_POS, Group::REF_QUAT, Group::REF_HEIGHT, Group::REF_HEADING, Group::REF_RATE]
                .into_iter()
                .any(is_read);
        self.assumed.clear();
        let decided = match (self.description.reference_kind, self.no_columns) {
            (Some(ReferenceKind::Readings), true) => Err(self.no_readings("reference.kind is `readings`")),
            (Some(ReferenceKind::FixedPoint), false) => {
                self.instead = Some(Instead::FixedPoint);
                Ok(())
            }
            (Some(ReferenceKind::Rests), _) => self.rest(false),
            (None, true) if has("attitude") => Err(self.no_readings("the filter measures attitude")),
            (None, true) if carried => self.rest(false),
            (None, false) if carried && velocity_alone => self.rest(true),
            _ => Ok(()),
        };
        if let Some(Instead::FixedPoint) = &self.instead {
            let ReferenceSigma { velocity, position, .. } = self.description.reference;
            self.assumed.push(format!(
                "the unit only turns in place: its velocity is zero within {velocity} m/s and its position that of the site within \
                 {position} m, all the time"
            ));
        }
        self.tell_priors();
        decided
    }

    fn no_readings(&self, why: &str) -> LogError {
        LogError::file(self.table(), format!("has no columns of a reference, and {why}"))
            .help("ref_vel_*, ref_pos_*, ref_quat_* are the columns; --map names them")
    }

    /// The rests that stand for a reference.
    pub fn rests(&self) -> &[Rest] {
        match &self.instead {
            Some(Instead::Rests(at_rest)) => &at_rest.rests,
            _ => &[],
        }
    }

    /// What is assumed of the reference, and of what the description leaves open there; in sentences.
    pub fn assumed(&self) -> &[String] {
        &self.assumed
    }

    /// Takes the rests for the reference; `columns` that hold anything but zero velocities of rests stay what they are.
    fn rest(&mut self, columns: bool) -> Result<(), LogError> {
        let before = self.instead.take();
        let description = self.description.clone();
        if !columns {
            self.presume();
        }
        let (found, held) = self.find_rests()?;
        if columns && (held.moves || held.readings == 0 || held.empty == 0 || found.rests.is_empty()) {
            (self.description, self.instead) = (description, before);
            return Ok(());
        }
        if found.rests.is_empty() {
            self.description = description;
            let problem = "has no columns of a reference, and the unit rests nowhere for a second";
            let help = "a hand-carried unit is calibrated by its rests: some seconds in each of nine positions and more; or give \
                        ref_vel_*; or [reference] kind = \"fixed-point\"";
            return Err(LogError::file(self.table(), problem).help(help));
        }
        self.contradicted(&found, held.warnings)?;
        let free = self.description.initial.is_none();
        let rests: Vec<Rest> = found.rests.iter().map(|rest| self.within(rest)).collect();
        let spread = self.rate_spread(&found.rests);
        let sigmas = rests.iter().map(|rest| {
            // what a bias is off by is the same all through a rest: its readings together say no more than one
            let readings = 1.0 + (rest.end_s - rest.start_s) * MEASURED_RATE.min(self.description.rate);
            spread * readings.sqrt()
        });
        let sigmas = sigmas.collect();
        self.tell_rests(&rests, spread, free);
        if let Some(noise) = found.noise.filter(|_| !columns && !self.description.noise_given) {
            let [gyro, accel] = [0, 1].map(|of| (noise[of].norm_squared() / 3.0).sqrt().max(LEAST_NOISE[of]));
            self.warnings.retain(|warning| !warning.contains(NO_NOISE));
            self.description.noise.angle_random_walk = gyro;
            self.description.noise.velocity_random_walk = accel;
            self.assumed.push(format!(
                "[noise] is not given: the rests show {:.3} deg/sqrt(h) and {:.0} ug/sqrt(Hz)",
                gyro / DEG_PER_SQRT_HOUR,
                accel / MICRO_G
            ));
        }
        let first_row = if free { rests[0].first_row } else { 0 };
        self.instead = Some(Instead::Rests(Arc::new(AtRest { rests, sigmas, first_row, columns })));
        Ok(())
    }

    /// What is not said of a hand-carried unit is that of its class, or of the MEMS class.
    fn presume(&mut self) {
        let description = &mut self.description;
        if description.grade.is_none() {
            if !description.noise_given {
                description.noise = Grade::Mems.noise();
            }
            if description.is_navigation_grade() {
                return;
            }
            description.presume(Grade::Mems);
        }
    }

    /// Says which priors are those of the class.
    fn tell_priors(&mut self) {
        let grade = self.description.grade.unwrap_or(Grade::Mems);
        let presumed = &self.description.presumed;
        let of_grade = grade.priors().iter().filter(|(name, ..)| presumed.contains(name));
        let filled: Vec<String> = of_grade.map(|(name, _, text)| format!("{name} {text}")).collect();
        if !filled.is_empty() {
            let filled = filled.join(", ");
            self.assumed.push(format!(
                "priors that are not given are those of the class `{}`: {filled}",
                grade.name()
            ));
        }
    }

    fn find_rests(&self) -> Result<(Rests, Columns), LogError> {
        let mut samples = self.samples()?;
        let mut finder = RestFinder::new(1.0 / self.description.rate);
        let mut channels = Channels::new(1.0 / self.description.rate);
        let mut columns = Columns::default();
        let mut last: Option<f64> = None;
        while let Some(sample) = samples.next() {
            let sample = sample?;
            let step =
                last.replace(sample.time).map_or(1.0 / self.description.rate, |last| sample.time - last);
            let (_, rate, force) = samples.as_rates(&sample, step);
            finder.push(sample.time, &rate, &force);
            channels.push(&rate, &force);
            columns.readings += u64::from(sample.reference.velocity.is_some());
            columns.empty += u64::from(sample.reference.velocity.is_none());
            columns.moves |= sample.reference.velocity.is_some_and(|velocity| velocity.amax() > 0.0);
        }
        let rests = finder.finish();
        columns.warnings = channels.warnings(&rests);
        Ok((rests, columns))
    }

    /// What the rests and the turns between them contradict: axes that are others are refused, all else is a warning.
    fn contradicted(&mut self, rests: &Rests, warnings: Vec<String>) -> Result<(), LogError> {
        if self.unknown != UnknownPulses::default() {
            return Ok(());
        }
        let path = self.table().to_owned();
        let other = match contradictions(rests) {
            Some(Contradiction::Axes(told)) => return Err(LogError::file(&path, told)),
            other => other.map(Contradiction::told),
        };
        let noise = self.noise_contradicted(rests)?;
        let odd = other.into_iter().chain(warnings).map(|warning| format!("{}: {warning}", path.display()));
        for warning in odd.chain(noise) {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        Ok(())
    }

    /// What the scatter in the rests makes of the noise that is stated: refused where that is far off.
    fn noise_contradicted(&self, rests: &Rests) -> Result<Vec<String>, LogError> {
        let Some([gyro, accel]) = rests.noise.filter(|_| self.description.noise_given) else {
            return Ok(Vec::new());
        };
        let stated = &self.description.noise;
        let path = self.noise_file.clone().unwrap_or_else(|| self.description_path());
        let mut warnings = Vec::new();
        for (seen, stated, field, unit, si) in [
            (gyro, stated.angle_random_walk, "gyro_arw_deg_sqrt_h", DEG_PER_SQRT_HOUR, "rad/s/sqrt(Hz)"),
            (accel, stated.velocity_random_walk, "accel_vrw_ug_sqrt_hz", MICRO_G, "m/s^2/sqrt(Hz)"),
        ] {
            let seen = (seen.norm_squared() / 3.0).sqrt();
            if !(seen > NOISIER * stated) {
                continue;
            }
            let (figure, wanted) = (stated / unit, figures(seen / unit));
            let is_si = (figure / seen).ln().abs() < NOISIER.ln();
            let looks = if is_si { format!(": this looks like {si}") } else { String::new() };
            let problem = format!(
                "noise.{field} is {figure:.3e}, and the rests scatter by {wanted}, {:.0} times as much{looks}",
                seen / stated
            );
            if seen > ABSURD * stated {
                let help = format!("write {field} = {wanted}, or leave [noise] out: then the rests show it");
                return Err(LogError::file(&path, problem).help(help));
            }
            warnings.push(format!("{}: {problem}", path.display()));
        }
        Ok(warnings)
    }

    /// A rest without its ends, where it is long enough to have some.
    fn within(&self, rest: &Rest) -> Rest {
        let rows = (EDGE * self.description.rate).round() as u64;
        if rest.last_row < rest.first_row + 5 * rows {
            return *rest;
        }
        Rest {
            start_s: rest.start_s + EDGE,
            end_s: rest.end_s - EDGE,
            first_row: rest.first_row + rows,
            last_row: rest.last_row - rows,
            ..*rest
        }
    }

    /// What the mean rate of a rest may be off by from the gyros' bias, rad/s: how much it differs from rest to rest, and the Earth's
    /// part where the heading is not known.
    fn rate_spread(&self, rests: &[Rest]) -> f64 {
        let wander = if rests.len() < FEWEST {
            WANDER
        } else {
            let rates = || rests.iter().map(|rest| Vector3::from(rest.rate));
            let mean = rates().sum::<Vector3<f64>>() / rests.len() as f64;
            let squares: f64 = rates().map(|rate| (rate - mean).norm_squared()).sum();
            (squares / (3.0 * (rests.len() - 1) as f64)).sqrt().max(LEAST_WANDER)
        };
        let known = self.description.initial.is_some_and(|initial| initial.heading_sigma < HEADING);
        wander.hypot(if known { 0.0 } else { earth::ROTATION_RATE })
    }

    fn tell_rests(&mut self, rests: &[Rest], spread: f64, free: bool) {
        let times: Vec<String> =
            rests.iter().map(|rest| format!("{:.1}-{:.1}", rest.start_s, rest.end_s)).collect();
        self.assumed.push(format!(
            "the unit is at rest {} times, at {} s: there its velocity is zero within {} m/s and its rate within {:.0} deg/h; what \
             the increments make of the motion between is believed to {MISSED_VELOCITY} m/s and to {:.2} deg and {:.1} % of the angle",
            rests.len(),
            times.join(", "),
            self.description.reference.velocity,
            spread / DEG_PER_HOUR,
            MISSED_ATTITUDE / DEGREE,
            100.0 * MISSED_OF_ANGLE
        ));
        if free {
            self.assumed.push(format!(
                "[initial] is not given: the run begins at {:.2} s in the first rest, level by gravity, with any heading; gyro biases \
                 contain what the Earth's rate makes of that, up to 15 deg/h",
                rests[0].start_s
            ));
        }
    }
}

/// A measured figure with three digits.
fn figures(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests;
