//! Checking rows and making samples of them.

use std::path::PathBuf;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use sinscal::{Reference, Sample};

use super::columns::{Batch, Group, NAMES, NEEDED};
use super::description::{Description, TEMPERATURES};
use super::fault::LogError;
use super::sections::UNIT_TOLERANCE;
use super::stamps::Plan;
use super::still::{STANDARD_GRAVITY, force_unit};

/// Median and mean step may differ from the nominal interval by this fraction.
const RATE_TOLERANCE: f64 = 0.02;
/// Fewer steps than this say nothing about the rate.
const STEPS_FOR_RATE: usize = 8;
/// Fewer rows than this say nothing about the mean specific force.
const ROWS_FOR_MEAN: usize = 64;
/// The mean specific force over a batch of rows lies in here, m/s^2: 9.8 unless on a centrifuge.
const MEAN_FORCE: (f64, f64) = (3.0, 50.0);
/// Nothing that carries an inertial unit goes beyond this, m/s^2.
const LARGEST_FORCE: f64 = 500.0;
/// Nor beyond this when it is shaken by hand, rad/s.
const LARGEST_RATE: f64 = 50.0;
/// Gyros of the navigation class are not turned faster than this, rad/s: 400 deg/s is the input range of ring
/// laser and fibre gyros. It is low enough to notice a turn at 10 deg/s written in degrees.
const LARGEST_NAVIGATION_RATE: f64 = 6.981_317_007_977_318;
/// rad/s: at 400 Hz it is 250 arcsec, what a gyro's own dither is; the block that carries the gyros moves less.
const LARGEST_DITHER: f64 = 4.0;
/// Other units of time, of which so many are a second.
const TIMES: [(f64, &str); 6] = [
    (1e3, "ms"),
    (1e6, "us"),
    (1e9, "ns"),
    (1.0 / 60.0, "minutes"),
    (1.0 / 3600.0, "h"),
    (1.0 / 86_400.0, "days"),
];
/// m/s and m.
const LARGEST_REFERENCE: [f64; 2] = [1e3, 1e6];

/// Standard deviations of one reading that a filter can compute with: m/s, m, rad.
const SIGMA: std::ops::RangeInclusive<f64> = 1e-9..=1e6;

/// What is written to rows where a whole triple is expected.
const TRIPLE: &str = "give all components in a row, or none";

/// Turns the rows of one table into samples, in order.
pub(super) struct Checker {
    path: PathBuf,
    interval: f64,
    largest_rate: f64,
    largest_force: f64,
    gyro_scale: Option<Vector3<f64>>,
    accel_scale: Option<Vector3<f64>>,
    reference: Measured,
    /// m.
    site_height: f64,
    /// Whether heights belong to latitudes and longitudes.
    placed: bool,
    plan: Plan,
    /// Row number of the last row, 0 before the first.
    row: u64,
    last_time: Option<f64>,
}

/// What the table says about the observed point.
enum Measured {
    /// Nothing: it is a fixed point, at rest in the origin.
    FixedPoint,
    /// What stands in its columns.
    Columns { velocity: bool, position: bool, attitude: bool },
}

/// A checked row.
pub(super) enum Row {
    /// One sampling interval after the row before.
    Next(Sample),
    /// After a gap of this many seconds.
    AfterGap(Sample, f64, LogError),
}

/// Whether nothing is said about the observed point: then it does not move.
pub(super) fn is_fixed_point(has: &dyn Fn(Group) -> bool) -> bool {
    let said = [
        Group::REF_VEL,
        Group::REF_POS,
        Group::REF_QUAT,
        Group::REF_HEIGHT,
        Group::REF_HEADING,
        Group::REF_RATE,
    ];
    !said.into_iter().chain(Group::REF_OWN.slots().map(|first| Group { first, len: 1 })).any(has)
}

impl Checker {
    /// `has` says which columns there are.
    pub(super) fn new(
        path: PathBuf,
        description: &Description,
        plan: Plan,
        has: &dyn Fn(Group) -> bool,
    ) -> Self {
        let reference = match [Group::REF_VEL, Group::REF_POS, Group::REF_QUAT].map(has) {
            [false, false, false] if is_fixed_point(has) => Measured::FixedPoint,
            [velocity, position, attitude] => Measured::Columns { velocity, position, attitude },
        };
        let largest_rate =
            if description.is_navigation_grade() { LARGEST_NAVIGATION_RATE } else { LARGEST_RATE };
        // pulses of unknown size count as they are, and may be many
        let scale = |group, size: Option<Vector3<f64>>, largest| match size {
            _ if !has(group) => (None, largest),
            None => (Some(Vector3::repeat(1.0)), f64::MAX),
            known => (known, largest),
        };
        let (gyro_scale, largest_rate) = scale(Group::GYRO_PULSE, description.gyro_pulse, largest_rate);
        let (accel_scale, largest_force) = scale(Group::ACCEL_PULSE, description.accel_pulse, LARGEST_FORCE);
        Self {
            path,
            interval: 1.0 / description.rate,
            largest_rate,
            largest_force,
            gyro_scale,
            accel_scale,
            reference,
            site_height: description.site.height,
            placed: has(Group::REF_LATLON),
            plan,
            row: 0,
            last_time: None,
        }
    }

    /// Checks what only many rows together show.
    pub(super) fn check_batch(&self, batch: &Batch) -> Result<(), LogError> {
        let rows = (self.row + 1, self.row + batch.rows as u64);
        let steps = batch.times().windows(2).map(|pair| pair[1] - pair[0]);
        let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
        if steps.len() >= STEPS_FOR_RATE {
            // The mean suffers from gaps, the median from times rounded to few digits; a wrong rate shows in both.
            let mean = steps.iter().sum::<f64>() / steps.len() as f64;
            let middle = steps.len() / 2;
            let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
            let median = *median;
            let wrong = |step: f64| (step / self.interval - 1.0).abs() > RATE_TOLERANCE;
            if median > 0.0 && wrong(median) && wrong(mean) {
                let problem = format!(
                    "rows {} to {} are {} s apart ({} Hz), the description says {} Hz",
                    rows.0,
                    rows.1,
                    figure(median, 6),
                    figure(1.0 / median, 3),
                    figure(1.0 / self.interval, 3)
                );
                let unit = TIMES.iter().find(|(size, _)| !wrong(median / size));
                let help = match unit {
                    Some((_, unit)) => format!("this looks like times in {unit}: seconds are expected"),
                    None if median == 1.0 => {
                        "this looks like row numbers: times in seconds are expected".into()
                    }
                    None => "correct imu.rate_hz of the description, or the times (in seconds)".into(),
                };
                return Err(LogError::column(&self.path, "time_s", problem).help(help));
            }
        }
        let mut sum = 0.0;
        let mut finite = 0_usize;
        for row in 0..batch.rows {
            let force = self.force(batch, row).norm() / self.interval;
            if force <= LARGEST_FORCE && self.largest_force == LARGEST_FORCE {
                sum += force;
                finite += 1;
            }
        }
        let mean = sum / finite as f64;
        if finite >= ROWS_FOR_MEAN && !(MEAN_FORCE.0..=MEAN_FORCE.1).contains(&mean) {
            let unit = force_unit(mean / STANDARD_GRAVITY, 1.0 / self.interval);
            let group = if self.accel_scale.is_some() { Group::ACCEL_PULSE } else { Group::DVEL };
            let dead = |slot: &usize| (0..batch.rows).all(|row| batch.cell(*slot, row) == 0.0);
            let dead: Vec<String> = group
                .slots()
                .filter(dead)
                .filter_map(|slot| Some(format!("`{}`", NAMES.get(slot)?)))
                .collect();
            if mean < MEAN_FORCE.0 && !dead.is_empty() && unit.is_none() {
                let problem = format!(
                    "rows {} to {}: the specific force is {mean:.3} m/s^2 on average, about 9.8 was expected, and {} read \
                     nothing but 0",
                    rows.0,
                    rows.1,
                    dead.join(", ")
                );
                let help = "is the sensor dead, or its column empty?";
                return Err(LogError::column(&self.path, &group.names().join("`, `"), problem).help(help));
            }
            let problem = format!(
                "rows {} to {}: the specific force is {mean:.3} m/s^2 on average, about 9.8 was expected{}",
                rows.0,
                rows.1,
                unit.map(|unit| format!(": this looks like {unit}")).unwrap_or_default()
            );
            let help = "velocity increments over one interval are expected, in m/s: not forces, and not in g; --map accel=NAME:m/s^2 reads \
                        forces";
            return Err(LogError::column(&self.path, &Group::DVEL.names().join("`, `"), problem).help(help));
        }
        Ok(())
    }

    /// Checks row `index` of the batch, which follows the row of the call before.
    pub(super) fn check(&mut self, batch: &Batch, index: usize) -> Result<Row, LogError> {
        self.row += 1;
        let time = batch.cell(Group::TIME.first, index);
        if !time.is_finite() {
            return Err(self.cell_fault(Group::TIME.first, time, "a time in s").help(NEEDED));
        }
        let gap = match self.last_time.replace(time) {
            None => None,
            Some(last) => self.step(last, time)?,
        };
        let dtheta = self.angle(batch, index);
        let dvel = self.force(batch, index);
        let gyro = if self.gyro_scale.is_some() { Group::GYRO_PULSE } else { Group::DTHETA };
        let accel = if self.accel_scale.is_some() { Group::ACCEL_PULSE } else { Group::DVEL };
        self.increments(gyro, &dtheta, self.largest_rate, ["an angle increment in rad", "rad/s"])?;
        self.increments(accel, &dvel, self.largest_force, ["a velocity increment in m/s", "m/s^2"])?;
        let sample = Sample {
            time,
            dtheta,
            dvel,
            temperature: self.temperature(batch, index, Group::TEMP)?,
            gyro_temperature: self.temperature(batch, index, Group::TEMP_GYRO)?,
            dither: self.dither(batch, index)?,
            reference: self.reference(batch, index)?,
        };
        Ok(match gap {
            None => Row::Next(sample),
            Some((gap, fault)) => Row::AfterGap(sample, gap, fault),
        })
    }

    /// The step from the row before: an error when time does not advance, something when it is a gap.
    fn step(&self, last: f64, time: f64) -> Result<Option<(f64, LogError)>, LogError> {
        let step = time - last;
        let fault = |problem: String| LogError::row(&self.path, self.row, Some("time_s"), problem);
        if step == 0.0 {
            return Err(fault(format!("{time} s repeats the time of the row before"))
                .help("times must increase; written with too few digits, or rows twice?"));
        }
        if step < 0.0 {
            return Err(
                fault(format!("{time} s follows {last} s")).help(
                    "times must increase from row to row: rows in disorder, files joined, or a clock that began anew?",
                )
            );
        }
        if step <= self.plan.longest_step * self.interval {
            return Ok(None);
        }
        let intervals = step / self.interval;
        let problem =
            format!("gap of {step:.6} s ({intervals:.1} sampling intervals) from {last} s to {time} s");
        let help = if self.plan.uneven {
            "many steps are longer and others shorter, and no row is missing: `--stamps trust` takes every step as long as it is, \
             `--stamps fit` puts a straight line through stamps that jitter"
        } else {
            "at most 1.5 intervals are allowed; `--bridge-gaps SECONDS` fills short gaps by interpolation"
        };
        Ok(Some((step, fault(problem).help(help))))
    }

    fn angle(&self, batch: &Batch, row: usize) -> Vector3<f64> {
        match &self.gyro_scale {
            None => triple(batch, row, Group::DTHETA),
            Some(scale) => triple(batch, row, Group::GYRO_PULSE).component_mul(scale),
        }
    }

    fn force(&self, batch: &Batch, row: usize) -> Vector3<f64> {
        match &self.accel_scale {
            None => triple(batch, row, Group::DVEL),
            Some(scale) => triple(batch, row, Group::ACCEL_PULSE).component_mul(scale),
        }
    }

    fn increments(
        &self,
        group: Group,
        values: &Vector3<f64>,
        largest: f64,
        [expected, unit]: [&str; 2],
    ) -> Result<(), LogError> {
        let limit = largest * self.interval;
        // False for NaN too.
        if values.iter().all(|value| value.abs() <= limit) {
            return Ok(());
        }
        for (axis, value) in values.iter().enumerate() {
            if !value.is_finite() {
                return Err(self.cell_fault(group.first + axis, *value, expected).help(NEEDED));
            }
            if value.abs() > limit {
                let problem = format!(
                    "{value} in {} s is {:.1} {unit}, beyond what a turntable or a hand does ({largest:.1} {unit})",
                    self.interval,
                    value / self.interval
                );
                let help = if unit == "rad/s" {
                    "degrees taken for radians? Angle increments over one interval are expected, not rates; --map gyro=NAME:deg/s \
                     reads rates"
                } else {
                    "velocity increments over one interval are expected, not forces; in m/s, not in g; --map accel=NAME:g reads forces"
                };
                let column = group.names().get(axis).copied();
                return Err(LogError::row(&self.path, self.row, column, problem).help(help));
            }
        }
        Ok(())
    }

    fn temperature(&self, batch: &Batch, row: usize, group: Group) -> Result<Vector3<f64>, LogError> {
        let values = triple(batch, row, group);
        let (low, high) = TEMPERATURES;
        self.readings(group, values, low, high, ["a temperature in degC", "in kelvin?"])
    }

    fn dither(&self, batch: &Batch, row: usize) -> Result<Vector3<f64>, LogError> {
        let values = triple(batch, row, Group::DITHER);
        let told = ["an amplitude in rad/s", "in deg/s?"];
        self.readings(Group::DITHER, values, 0.0, LARGEST_DITHER, told)
    }

    /// Readings of which each may be missing.
    fn readings(
        &self,
        group: Group,
        values: Vector3<f64>,
        low: f64,
        high: f64,
        [expected, too_large]: [&str; 2],
    ) -> Result<Vector3<f64>, LogError> {
        for (axis, value) in values.iter().enumerate() {
            if *value < low || *value > high {
                let expected = format!("{expected} from {low} to {high}");
                let fault = self.cell_fault(group.first + axis, *value, &expected);
                return Err(if *value > high { fault.help(too_large) } else { fault });
            }
        }
        Ok(values)
    }

    fn reference(&self, batch: &Batch, row: usize) -> Result<Reference, LogError> {
        let Measured::Columns { velocity, position, attitude } = self.reference else {
            let rest = Some(Vector3::zeros());
            return Ok(Reference { velocity: rest, position: rest, ..Reference::default() });
        };
        let mut reference = self.single(batch, row)?;
        if velocity {
            let values = triple(batch, row, Group::REF_VEL);
            reference.velocity =
                self.whole(Group::REF_VEL, values, LARGEST_REFERENCE[0], "a velocity in m/s")?;
        }
        if position {
            let values = triple(batch, row, Group::REF_POS);
            reference.position =
                self.whole(Group::REF_POS, values, LARGEST_REFERENCE[1], "a position in m")?;
        }
        if attitude {
            reference.attitude = self.quaternion(batch, row)?;
        }
        Ok(reference)
    }

    /// Height and heading, and the standard deviations that the row states itself.
    fn single(&self, batch: &Batch, row: usize) -> Result<Reference, LogError> {
        let mut reference = Reference::default();
        let number = |slot: usize| Some(batch.cell(slot, row)).filter(|value| !value.is_nan());
        // with latitude and longitude it is part of a position
        if let Some(height) = number(Group::REF_HEIGHT.first).filter(|_| !self.placed) {
            let over = height - self.site_height;
            if !(over.abs() <= LARGEST_REFERENCE[1]) {
                return Err(self.cell_fault(
                    Group::REF_HEIGHT.first,
                    height,
                    "a height over the ellipsoid in m",
                ));
            }
            reference.height = Some(over);
        }
        if let Some(heading) = number(Group::REF_HEADING.first) {
            if !heading.is_finite() {
                return Err(self.cell_fault(Group::REF_HEADING.first, heading, "a heading in deg"));
            }
            reference.heading = Some(heading);
        }
        let rate = triple(batch, row, Group::REF_RATE);
        reference.rate = self.whole(Group::REF_RATE, rate, LARGEST_RATE, "a rate in rad/s")?;
        for (own, slot) in reference.own.iter_mut().zip(Group::REF_OWN.slots()) {
            *own = batch.cell(slot, row);
            if own.is_infinite() {
                return Err(self.cell_fault(slot, *own, "a reading"));
            }
        }
        let sigma = |slot: usize| match number(slot) {
            Some(value) if !SIGMA.contains(&value) => {
                let fault = self.cell_fault(slot, value, "one standard deviation, above 0,");
                Err(fault.help("leave the field empty where none is known"))
            }
            value => Ok(value.unwrap_or(f64::NAN)),
        };
        let three = |group: Group| -> Result<Vector3<f64>, LogError> {
            Ok(Vector3::new(sigma(group.first)?, sigma(group.first + 1)?, sigma(group.first + 2)?))
        };
        reference.sigma.velocity = three(Group::REF_VEL_SIGMA)?;
        reference.sigma.position = three(Group::REF_POS_SIGMA)?;
        reference.sigma.height = reference.sigma.position.z;
        let attitude = sigma(Group::REF_ATT_SIGMA.first)?;
        reference.sigma.attitude = Vector3::repeat(attitude);
        reference.sigma.heading = attitude;
        Ok(reference)
    }

    /// A triple that is there or not.
    fn whole(
        &self,
        group: Group,
        values: Vector3<f64>,
        largest: f64,
        expected: &str,
    ) -> Result<Option<Vector3<f64>>, LogError> {
        if values.iter().all(|value| value.abs() <= largest) {
            return Ok(Some(values));
        }
        if values.iter().all(|value| value.is_nan()) {
            return Ok(None);
        }
        Err(self.partly(group, values.as_slice(), largest, expected))
    }

    fn quaternion(&self, batch: &Batch, row: usize) -> Result<Option<UnitQuaternion<f64>>, LogError> {
        let group = Group::REF_QUAT;
        let [w, x, y, z] = std::array::from_fn(|index| batch.cell(group.first + index, row));
        let values = [w, x, y, z];
        if values.iter().all(|value| value.is_nan()) {
            return Ok(None);
        }
        if !values.iter().all(|value| value.is_finite()) {
            return Err(self.partly(
                group,
                &values,
                1.0 + UNIT_TOLERANCE,
                "a component of a unit quaternion",
            ));
        }
        let quaternion = Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if (norm - 1.0).abs() > UNIT_TOLERANCE {
            let problem = format!("has norm {norm:.6}, a unit quaternion was expected (within 0.001)");
            let names = group.names().join("`, `");
            let help = if norm == 0.0 {
                "leave the four fields empty, or write NaN, where there is no reading"
            } else {
                "w, x, y, z are the components of a rotation: cos and sin of half its angle, no angles"
            };
            return Err(LogError::row(&self.path, self.row, Some(&names), problem).help(help));
        }
        Ok(Some(UnitQuaternion::from_quaternion(quaternion)))
    }

    #[cold]
    fn partly(&self, group: Group, values: &[f64], largest: f64, expected: &str) -> LogError {
        let faulty = values.iter().position(|value| value.is_nan() || value.abs() > largest).unwrap_or(0);
        let value = values.get(faulty).copied().unwrap_or(f64::NAN);
        if value.is_nan() {
            let fault = self.cell_fault(group.first + faulty, value, expected);
            return fault.help(format!("{}: {TRIPLE}", group.names().join(", ")));
        }
        let fault = self.cell_fault(group.first + faulty, value, &format!("{expected} within +-{largest}"));
        match group {
            Group::REF_POS => {
                fault.help("east, north and up of the site, in m; not Earth-fixed, not degrees")
            }
            _ => fault,
        }
    }

    #[cold]
    fn cell_fault(&self, slot: usize, value: f64, expected: &str) -> LogError {
        let column = super::columns::NAMES.get(slot).copied();
        LogError::row(&self.path, self.row, column, format!("is {value}, {expected} was expected"))
    }
}

/// A number with so many decimals, or a power of ten where these would not show it.
fn figure(value: f64, decimals: usize) -> String {
    if (1e-3..1e7).contains(&value.abs()) { format!("{value:.decimals$}") } else { format!("{value:.3e}") }
}

fn triple(batch: &Batch, row: usize, group: Group) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| batch.cell(group.first + axis, row))
}
