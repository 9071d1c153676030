//! What must be known to run a filter over a log, and what is wrong with it.

use core::f64::consts::PI;
use core::fmt;

use calib_core::declare::distance;
use calib_core::{Block, Filter, MeasurementInfo, Relaxation, Shape};
use nalgebra::{UnitQuaternion, Vector3};

use crate::{
    AccelBiasRandomWalk, AccelBiasWander, Fault, GyroBiasRandomWalk, GyroBiasWander, OpenBlocks, Strapdown,
    probe,
};

/// What must be known to run a filter over a log, in SI units.
///
/// ```
/// use sinscal::{InitialAttitude, ReferenceSigma, SensorNoise, Setup, Site};
///
/// let setup = Setup {
///     priors: &[("accel-bias", 5e-3)],
///     ..Setup::new(
///         50.0,
///         Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
///         InitialAttitude { level_sigma: 5e-4, ..InitialAttitude::unknown_heading() },
///         ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
///         SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
///     )
/// };
/// setup.check::<sinscal::Sins36P>()?;
///
/// let mistyped = Setup { priors: &[("acel-bias", 5e-3)], ..setup };
/// let error = mistyped.check::<sinscal::Sins36P>().unwrap_err();
/// assert_eq!(error.to_string(), "`priors`: there is no block `acel-bias`; did you mean `accel-bias`?");
/// # Ok::<(), sinscal::SetupError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<'a> {
    /// Nominal sampling rate of the IMU, Hz.
    pub rate: f64,
    /// Where the log was taken.
    pub site: Site,
    /// Attitude at the start of the first interval.
    pub initial: InitialAttitude,
    /// Velocity of the IMU at the first sample.
    pub velocity: InitialVelocity,
    /// Standard deviations of one reference reading.
    pub reference: ReferenceSigma,
    /// The reference is used at most this often, Hz.
    pub update_rate: f64,
    /// Random walks of the sensors.
    pub noise: SensorNoise,
    /// Temperature at which temperature effects vanish, degC.
    pub reference_temperature: f64,
    /// First guess of the outer lever arm, b, m: from the IMU's sensitive centre to the observed point.
    pub outer_lever: Vector3<f64>,
    /// Prior standard deviations that replace a block's default, by block name, SI.
    pub priors: &'a [(&'a str, f64)],
    /// Standard deviations of a reading that replace a measurement's default, by measurement name, SI.
    pub sigmas: &'a [(&'a str, f64)],
    /// Correlation times, s, that replace those of Gauss-Markov blocks, by block name. Such a block is stationary: what drives it
    /// keeps its standard deviation at the prior's.
    pub correlation_times: &'a [(&'a str, f64)],
    /// How the biases wander, where that is known: it goes before what the blocks of those names say themselves.
    pub wander: BiasWander,
    /// Blocks whose states are considered, beside those that the declaration marks so: they keep their priors, and what these make
    /// uncertain is in the covariance of the others ([`Kalman::consider`](crate::Kalman::consider)).
    pub considered: &'a [&'a str],
    /// What joins a filter with the block [`Open`](crate::Open).
    pub open: OpenBlocks,
}

/// The origin of the local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Geodetic latitude, rad.
    pub latitude: f64,
    /// Longitude, rad.
    pub longitude: f64,
    /// Height over the ellipsoid, m.
    pub height: f64,
}

/// Coarse attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialAttitude {
    /// C_bn.
    pub attitude: UnitQuaternion<f64>,
    /// Standard deviation of the tilt about east and about north, rad.
    pub level_sigma: f64,
    /// Standard deviation of the rotation about up, rad: up to pi, where nothing is known of it.
    pub heading_sigma: f64,
}

impl InitialAttitude {
    /// Level by the mean specific force of a unit at rest (b, m/s^2), as far as accelerometers of that bias (m/s^2) tell, whatever the
    /// heading.
    pub fn at_rest(force: &Vector3<f64>, accel_bias_sigma: f64) -> Self {
        // of the turns that lead straight up any will do where the force points straight down
        let over = UnitQuaternion::from_scaled_axis(Vector3::x() * PI);
        let attitude = UnitQuaternion::rotation_between(force, &Vector3::z()).unwrap_or(over);
        let level_sigma = (accel_bias_sigma / force.norm()).clamp(PI / 180.0, PI);
        Self { attitude, level_sigma, ..Self::unknown_heading() }
    }

    /// Level within 1 deg, whatever the heading.
    pub fn unknown_heading() -> Self {
        Self { attitude: UnitQuaternion::identity(), level_sigma: PI / 180.0, heading_sigma: PI }
    }
}

/// Velocity at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialVelocity {
    /// Over ground, ENU, m/s. A reading at the first sample takes its place where that is the better known.
    pub velocity: Vector3<f64>,
    /// Its standard deviation per component, m/s.
    pub sigma: f64,
}

impl Default for InitialVelocity {
    /// At rest within 0.5 m/s: the first reading of velocity or position replaces it.
    fn default() -> Self {
        Self { velocity: Vector3::zeros(), sigma: 0.5 }
    }
}

/// Standard deviations of one reference reading, per component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSigma {
    /// Velocity, m/s.
    pub velocity: f64,
    /// Position, m.
    pub position: f64,
    /// Attitude, rad.
    pub attitude: f64,
}

/// Random walks of the sensors, the same on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorNoise {
    /// Angle random walk, rad/sqrt(s).
    pub angle_random_walk: f64,
    /// Velocity random walk, (m/s)/sqrt(s).
    pub velocity_random_walk: f64,
}

/// How biases wander, the same on each axis: gyros (rad/s) first, then accelerometers (m/s^2). Nothing stands for what is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiasWander {
    /// Random walk, per square root of a second.
    pub random_walk: [Option<f64>; 2],
    /// Gauss-Markov process: standard deviation and correlation time, s.
    pub gauss_markov: [Option<(f64, f64)>; 2],
}

impl BiasWander {
    /// The effects that say what is known.
    pub fn effects(&self) -> impl Iterator<Item = &'static str> {
        let (walks, wanders) = (self.random_walk, self.gauss_markov);
        (0..2)
            .filter(move |i| wanders[*i].is_some())
            .map(|i| GAUSS_MARKOV[i])
            .chain((0..2).filter(move |i| walks[*i].is_some()).map(|i| RANDOM_WALK[i]))
    }

    /// Standard deviation and correlation time of a Gauss-Markov block.
    fn gauss_markov(&self, block: &str) -> Option<(f64, f64)> {
        GAUSS_MARKOV.iter().position(|name| *name == block).and_then(|i| self.gauss_markov[i])
    }

    /// Random walk of a block that walks.
    fn random_walk(&self, block: &str) -> Option<f64> {
        RANDOM_WALK.iter().position(|name| *name == block).and_then(|i| self.random_walk[i])
    }

    /// The figure that is the least, or none at all; infinite where nothing is known.
    fn least(&self) -> f64 {
        let walks = self.random_walk.iter().flatten().copied();
        let wanders = self.gauss_markov.iter().flatten().flat_map(|(sigma, time)| [*sigma, *time]);
        walks.chain(wanders).fold(f64::MAX, |least, figure| if figure >= least { least } else { figure })
    }
}

const GAUSS_MARKOV: [&str; 2] = [GyroBiasWander::NAME, AccelBiasWander::NAME];
const RANDOM_WALK: [&str; 2] = [GyroBiasRandomWalk::NAME, AccelBiasRandomWalk::NAME];

impl<'a> Setup<'a> {
    /// With what has to be said. The rest is a unit at rest, a reference used at most once a second, temperature effects that vanish
    /// at 25 degC, an observed point in the IMU's centre, and the defaults of blocks and measurements.
    pub fn new(
        rate: f64,
        site: Site,
        initial: InitialAttitude,
        reference: ReferenceSigma,
        noise: SensorNoise,
    ) -> Self {
        Self {
            rate,
            site,
            initial,
            velocity: InitialVelocity::default(),
            reference,
            update_rate: 1.0,
            noise,
            reference_temperature: 25.0,
            outer_lever: Vector3::zeros(),
            priors: &[],
            sigmas: &[],
            correlation_times: &[],
            wander: BiasWander::default(),
            considered: &[],
            open: OpenBlocks::NONE,
        }
    }

    /// Whether filter `F` can be run with it. A name counts as known that the catalogue of effects or our measurements have,
    /// so that one setup serves several filters.
    ///
    /// # Errors
    /// The first number or name that is wrong; a block of the filter that contradicts itself.
    pub fn check<F: Filter<Dynamics = Strapdown>>(&self) -> Result<(), SetupError> {
        probe::<F>().map_err(SetupError::Block)?;
        self.check_numbers()?;
        let blocks = |wanted: &str, near: &mut Near| {
            let mut found = crate::effect(wanted).is_some();
            let mut i = 0;
            self.open.states_of::<F>(&mut |info| {
                if i >= F::Shape::CORE {
                    near.look_at(info.block);
                    found |= info.block == wanted;
                }
                i += 1;
            });
            found
        };
        let measurements = |wanted: &str, near: &mut Near| {
            let all = crate::measurements::OURS.iter().chain(F::MEASURES);
            all.fold(false, |found, info| {
                near.look_at(info.name);
                found | (info.name == wanted)
            })
        };
        check_names("priors", "block", self.priors, |sigma| sigma >= 0.0, "zero or more", blocks)?;
        check_names("sigmas", "measurement", self.sigmas, |sigma| sigma > 0.0, "positive", measurements)?;
        for name in self.considered {
            check_names("considered", "block", &[(*name, 1.0)], |_| true, "", blocks)?;
        }
        let relaxing = |wanted: &str, near: &mut Near| blocks(wanted, near) && !is_constant::<F>(wanted);
        let times = self.correlation_times;
        check_names("correlation_times", "Gauss-Markov block", times, |time| time > 0.0, "positive", relaxing)
    }

    fn check_numbers(&self) -> Result<(), SetupError> {
        let (site, initial, noise) = (&self.site, &self.initial, &self.noise);
        let vector = |v: &Vector3<f64>| v.iter().fold(0.0, |sum: f64, x| sum + x);
        let norm = initial.attitude.as_ref().norm();
        let numbers: [Rule; 18] = [
            ("rate", self.rate, |x| x > 0.0, "positive"),
            ("site.latitude", site.latitude, |x| x.abs() <= PI / 2.0, "within a quarter turn, in rad"),
            ("site.longitude", site.longitude, |_| true, "a number"),
            ("site.height", site.height, |_| true, "a number"),
            ("initial.attitude", norm, |x| (x - 1.0).abs() < 1e-6, "of norm 1"),
            ("initial.level_sigma", initial.level_sigma, |x| (0.0..=PI).contains(&x), "between 0 and pi"),
            ("initial.heading_sigma", initial.heading_sigma, |x| (0.0..=PI).contains(&x), "between 0 and pi"),
            ("velocity.velocity", vector(&self.velocity.velocity), |_| true, "three numbers"),
            ("velocity.sigma", self.velocity.sigma, |x| x >= 0.0, "zero or more"),
            ("reference.velocity", self.reference.velocity, |x| x > 0.0, "positive"),
            ("reference.position", self.reference.position, |x| x > 0.0, "positive"),
            ("reference.attitude", self.reference.attitude, |x| x > 0.0, "positive"),
            ("update_rate", self.update_rate, |x| x > 0.0, "positive"),
            ("noise.angle_random_walk", noise.angle_random_walk, |x| x >= 0.0, "zero or more"),
            ("noise.velocity_random_walk", noise.velocity_random_walk, |x| x >= 0.0, "zero or more"),
            ("reference_temperature", self.reference_temperature, |_| true, "a number"),
            ("outer_lever", vector(&self.outer_lever), |_| true, "three numbers"),
            ("wander", self.wander.least(), |x| x > 0.0, "positive"),
        ];
        match numbers.into_iter().find(|(_, value, holds, _)| !(value.is_finite() && holds(*value))) {
            Some((field, value, _, wanted)) => {
                Err(SetupError::Number { field, name: Word::NONE, value, wanted })
            }
            None => Ok(()),
        }
    }

    /// Prior standard deviation that it names for a block.
    pub fn prior(&self, block: &str) -> Option<f64> {
        named(self.priors, block).or_else(|| self.wander.gauss_markov(block).map(|(sigma, _)| sigma))
    }

    /// Standard deviation of a row of a measurement that states none.
    pub fn sigma(&self, measurement: &MeasurementInfo) -> f64 {
        named(self.sigmas, measurement.name).unwrap_or(match measurement.name {
            "velocity" => self.reference.velocity,
            "position" => self.reference.position,
            "attitude" => self.reference.attitude,
            _ => measurement.sigma,
        })
    }

    /// How a state relaxes that is declared to: that of the block, or stationary with the correlation time that is named here.
    /// One whose prior says that it takes no part is constant.
    pub(crate) fn relaxation(&self, block: &str, prior: f64, declared: Relaxation<f64>) -> Relaxation<f64> {
        if prior == 0.0 {
            return Relaxation { rate: 0.0, density: 0.0 };
        }
        let stated = self.wander.gauss_markov(block).map(|(_, time)| time);
        match named(self.correlation_times, block).or(stated) {
            Some(time) => Relaxation { rate: 1.0 / time, density: 2.0 * prior * prior / time },
            None => match self.wander.random_walk(block) {
                Some(walk) => Relaxation { rate: 0.0, density: walk * walk },
                None => declared,
            },
        }
    }
}

/// A field of the setup: its name, its value, whether the value will do, and what would be right.
type Rule = (&'static str, f64, fn(f64) -> bool, &'static str);

fn named(list: &[(&str, f64)], name: &str) -> Option<f64> {
    list.iter().find(|(named, _)| *named == name).map(|(_, value)| *value)
}

/// Whether `block` is one of the filter's and does not relax.
fn is_constant<F: Filter>(block: &str) -> bool {
    let relaxing = calib_core::relaxing::<F, f64>();
    let (mut i, mut constant) = (0, false);
    F::states(&mut |info| {
        let Relaxation { rate, density } = relaxing[i];
        constant |= info.block == block && rate == 0.0 && density == 0.0;
        i += 1;
    });
    constant
}

/// The known name nearest to one that is not.
struct Near<'a> {
    wanted: &'a str,
    best: Option<(usize, &'static str)>,
}

impl Near<'_> {
    fn look_at(&mut self, known: &'static str) {
        let edits = distance(known, self.wanted);
        if edits <= known.len() / 3 && self.best.is_none_or(|(least, _)| edits < least) {
            self.best = Some((edits, known));
        }
    }
}

fn check_names(
    field: &'static str,
    what: &'static str,
    list: &[(&str, f64)],
    holds: fn(f64) -> bool,
    wanted: &'static str,
    is_known: impl Fn(&str, &mut Near) -> bool,
) -> Result<(), SetupError> {
    for (name, value) in list {
        let mut near = Near { wanted: name, best: None };
        if !is_known(name, &mut near) {
            let near = near.best.map(|(_, known)| known).filter(|known| known != name);
            return Err(SetupError::Name { field, what, name: Word::of(name), near });
        }
        if !holds(*value) {
            return Err(SetupError::Number { field, name: Word::of(name), value: *value, wanted });
        }
    }
    Ok(())
}

/// What is wrong with a [`Setup`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// A number that no run can begin with.
    #[non_exhaustive]
    Number {
        /// The field, for instance `site.latitude`.
        field: &'static str,
        /// The name that it stands beside, where the field is a list.
        name: Word,
        /// What it is.
        value: f64,
        /// What it should be.
        wanted: &'static str,
    },
    /// A block of the filter contradicts itself.
    Block(Fault),
    /// A name that nothing has.
    #[non_exhaustive]
    Name {
        /// The list that it stands in, for instance `priors`.
        field: &'static str,
        /// What should have the name.
        what: &'static str,
        /// The name.
        name: Word,
        /// A name that looks like it.
        near: Option<&'static str>,
    },
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number { field, name, value, wanted } if *name == Word::NONE => {
                write!(f, "`{field}` is {value}, it should be {wanted}")
            }
            Self::Number { field, name, value, wanted } => {
                write!(f, "`{field}`: that of `{name}` is {value}, it should be {wanted}")
            }
            Self::Block(fault) => write!(f, "{fault}"),
            Self::Name { field, what, name, near } => {
                write!(f, "`{field}`: there is no {what} `{name}`")?;
                near.map_or(Ok(()), |near| write!(f, "; did you mean `{near}`?"))
            }
        }
    }
}

impl core::error::Error for SetupError {}

/// A name that was given, its first 40 bytes: an error outlives the setup, and nothing is allocated.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Word {
    bytes: [u8; 40],
    len: usize,
}

impl Word {
    const NONE: Self = Self { bytes: [0; 40], len: 0 };

    fn of(name: &str) -> Self {
        let mut word = Self::NONE;
        for c in name.chars() {
            let end = word.len + c.len_utf8();
            if end > word.bytes.len() {
                break;
            }
            c.encode_utf8(&mut word.bytes[word.len..end]);
            word.len = end;
        }
        word
    }

    /// The name.
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes[..self.len]).unwrap_or_default()
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
