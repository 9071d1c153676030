//! Cutting a log into pieces in which the system is nearly constant.

use calib_core::Shape;
use nalgebra::{ComplexField, UnitQuaternion, Vector3};

use crate::compensation::Compensator;
use crate::strapdown::{Before, NavigationState};
use crate::{Filter, Point, Sample, Setup, Signals, Sins43B, Site, earth};

/// Motion is judged over blocks of this length, s.
const BLOCK: f64 = 0.2;
/// A unit turns when it is faster than this beside noise and bias, rad/s (0.1 deg/s).
const TURNING: f64 = 2e-3;
/// A turning piece ends when it has turned by this much, rad (100 deg): a quarter turn is one piece.
const LARGEST_TURN: f64 = 1.75;
/// A turning piece ends when the axis has moved by more than 60 deg.
const SAME_AXIS: f64 = 0.5;
/// A still piece ends after this time, s: temperature and dither change.
const LONGEST_REST: f64 = 300.0;

/// A stretch of a log in which the unit rests, or turns about one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Time at its start, s.
    pub start: f64,
    /// Its length, s.
    pub duration: f64,
    /// Whether the unit turns.
    pub turning: bool,
    /// Mean signals; the force is the mean force in n, seen from the attitude at the middle.
    pub signals: Signals<f64>,
    /// Attitude at the middle, the unit otherwise at its place.
    pub point: Point<f64>,
}

/// Cuts a log into [`Segment`]s, sample by sample.
///
/// Made for a unit that is turned about a place of its own: velocity is zero, the specific force changes in b by turning alone, and
/// what linear acceleration shows of a delay is not counted.
///
/// The attitude is that of the gyros from the initial one on, or the reference's where there is one; sensor errors hardly
/// matter for where the system is linearised.
#[derive(Clone, Debug)]
pub struct Segmenter {
    site: Site,
    lever: Vector3<f64>,
    turning_rate: f64,
    rate: f64,
    compensator: Compensator,
    navigation: NavigationState<f64>,
    before: Before<f64>,
    time: Option<f64>,
    block: Sums,
    piece: Option<(bool, Sums)>,
}

#[derive(Clone, Copy, Debug)]
struct Sums {
    start: f64,
    time: f64,
    begin: UnitQuaternion<f64>,
    end: UnitQuaternion<f64>,
    turn: Vector3<f64>,
    angle: f64,
    velocity_n: Vector3<f64>,
    first_rate: Vector3<f64>,
    last_rate: Vector3<f64>,
    temperature: Vector3<f64>,
    temperature_rate: Vector3<f64>,
    gyro_temperature: Vector3<f64>,
    dither: Vector3<f64>,
    since: f64,
}

impl Sums {
    fn at(start: f64, attitude: UnitQuaternion<f64>) -> Self {
        let zero = Vector3::zeros();
        Self {
            start,
            time: 0.0,
            begin: attitude,
            end: attitude,
            turn: zero,
            angle: 0.0,
            velocity_n: zero,
            first_rate: zero,
            last_rate: zero,
            temperature: zero,
            temperature_rate: zero,
            gyro_temperature: zero,
            dither: zero,
            since: 0.0,
        }
    }

    fn add(&mut self, signals: &Signals<f64>, end: UnitQuaternion<f64>, dt: f64) {
        if self.time == 0.0 {
            self.first_rate = signals.rate;
        }
        self.last_rate = signals.rate;
        self.time += dt;
        self.velocity_n += (self.end.slerp(&end, 0.5) * signals.force) * dt;
        self.end = end;
        self.turn += signals.rate * dt;
        self.angle += signals.rate.norm() * dt;
        self.temperature += signals.temperature * dt;
        self.temperature_rate += signals.temperature_rate * dt;
        self.gyro_temperature += signals.gyro_temperature * dt;
        self.dither += signals.dither * dt;
        self.since += signals.time * dt;
    }

    fn join(&mut self, next: &Self) {
        if self.time == 0.0 {
            self.first_rate = next.first_rate;
        }
        self.last_rate = next.last_rate;
        self.time += next.time;
        self.velocity_n += next.velocity_n;
        self.end = next.end;
        self.turn += next.turn;
        self.angle += next.angle;
        self.temperature += next.temperature;
        self.temperature_rate += next.temperature_rate;
        self.gyro_temperature += next.gyro_temperature;
        self.dither += next.dither;
        self.since += next.since;
    }
}

impl Segmenter {
    /// Begins at the first sample of a log.
    pub fn new(setup: &Setup) -> Self {
        let prior = |name: &str| {
            setup.prior(name).or_else(|| crate::effect(name).map(|effect| effect.prior_sigma)).unwrap_or(0.0)
        };
        let noise = setup.noise.angle_random_walk / ComplexField::sqrt(BLOCK);
        Self {
            site: setup.site,
            lever: setup.outer_lever,
            turning_rate: TURNING + 6.0 * noise + 3.0 * prior("gyro-bias"),
            rate: setup.rate,
            compensator: Compensator::new(setup.reference_temperature),
            navigation: NavigationState::at_rest(&setup.site, setup.initial.attitude),
            before: Before::nothing(),
            time: None,
            block: Sums::at(0.0, setup.initial.attitude),
            piece: None,
        }
    }

    /// Takes in the next sample; a segment that ended before it comes back.
    pub fn push(&mut self, sample: &Sample) -> Option<Segment> {
        let nominal = 1.0 / self.rate;
        let before = *self.time.get_or_insert(sample.time - nominal);
        let dt = sample.time - before;
        if self.block.time == 0.0 {
            self.block.start = before;
        }
        self.time = Some(sample.time);
        self.compensator.read(sample);
        let none = <Sins43B as Filter>::Shape::vector(0.0);
        let (now, signals) = self.compensator.compensate::<Sins43B>(sample, dt, &none);
        // the attitude alone moves: the unit stays where it is
        self.navigation.step(&now, &mut self.before, dt);
        let attitude = sample.reference.attitude.unwrap_or(self.navigation.attitude);
        self.navigation = NavigationState::at_rest(&self.site, attitude);
        self.block.add(&signals, attitude, dt);
        // half a sample of slack against rounding
        if self.block.time < BLOCK - 0.5 * nominal { None } else { self.close_block() }
    }

    /// The segment that the log ends with.
    pub fn finish(mut self) -> Option<Segment> {
        if let Some((_, piece)) = self.piece.as_mut().filter(|_| self.block.time > 0.0) {
            piece.join(&self.block);
        }
        self.piece.map(|(turning, piece)| self.segment(turning, &piece))
    }

    fn close_block(&mut self) -> Option<Segment> {
        let block = core::mem::replace(&mut self.block, Sums::at(0.0, self.navigation.attitude));
        let turning = block.turn.norm() > self.turning_rate * block.time;
        let mut ended = None;
        if let Some((was_turning, piece)) = &mut self.piece {
            let goes_on = if turning {
                piece.angle + block.angle <= LARGEST_TURN
                    && piece.turn.dot(&block.turn) >= SAME_AXIS * piece.turn.norm() * block.turn.norm()
            } else {
                piece.time + block.time <= LONGEST_REST
            };
            if turning == *was_turning && goes_on {
                piece.join(&block);
                return None;
            }
            ended = Some((*was_turning, *piece));
        }
        self.piece = Some((turning, block));
        ended.map(|(turning, piece)| self.segment(turning, &piece))
    }

    fn segment(&self, turning: bool, sums: &Sums) -> Segment {
        let time = sums.time;
        let attitude = sums.begin.slerp(&sums.end, 0.5);
        let c_bn = attitude.to_rotation_matrix().into_inner();
        let force_n = sums.velocity_n / time;
        let rate = sums.turn / time;
        let site = NavigationState::<f64>::at_rest(&self.site, attitude);
        let dither = sums.dither / time;
        let force = c_bn.transpose() * force_n;
        let signals = Signals {
            rate,
            angular_acceleration: (sums.last_rate - sums.first_rate) / time,
            force,
            force_rate: force.cross(&rate),
            temperature: sums.temperature / time,
            temperature_rate: sums.temperature_rate / time,
            gyro_temperature: sums.gyro_temperature / time,
            dither,
            coupled_dither: dither,
            time: sums.since / time,
            ..Signals::default()
        };
        let rate_eb = rate - c_bn.transpose() * earth::rotation_n(self.site.latitude);
        let point = Point {
            c_bn,
            velocity: Vector3::zeros(),
            latitude: site.latitude,
            height: site.height,
            position: -(c_bn * self.lever),
            force_n,
            rate_eb,
            lever: self.lever,
            point_velocity: c_bn * rate_eb.cross(&self.lever),
            point_acceleration: c_bn * rate_eb.cross(&rate_eb.cross(&self.lever)),
            point_position: Vector3::zeros(),
            ..Point::default()
        };
        Segment { start: sums.start, duration: time, turning, signals, point }
    }
}
