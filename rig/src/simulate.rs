//! The simulation: a stream of samples.

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{
    AccelBiasRandomWalk, AccelBiasWander, BiasWander, Effect as _, EffectInfo, GyroBiasRandomWalk,
    GyroBiasWander, Point, Reference, ReferenceSigma, Sample, SensorNoise, Signals, Site,
};

use crate::description::Description;
use crate::dither::FullDither;
use crate::environment::{Amplitudes, Temperatures, ThermometerErrors};
use crate::mechanics::{Felt, Place};
use crate::motion::{Centre, Motion, Rotation};
use crate::noise::Noise;
use crate::random::{Seed, Stream};
use crate::scenario::{DitherMode, Scenario, ScenarioError};
use crate::sensors::Sensors;
use crate::truth::Truth;

/// Nodes and weights of Gauss and Legendre's quadrature of three points over an interval of length one.
pub(crate) const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// A fixed point holds at every instant; it is used at this rate, Hz.
const FIXED_POINT_RATE: f64 = 1.0;

/// One unit on its table: an iterator over the samples of its log.
///
/// It holds no samples: a log of any length takes the same memory. The same scenario and seed give the same bits.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// True length of an interval, s, and true rate; what the clock of the log makes of a second.
    dt: f64,
    rate: f64,
    clock: f64,
    samples: u64,
    next: u64,
    truth: Truth,
    description: Description,
    motion: Motion,
    table: crate::motion::Imperfections,
    rigid: bool,
    panels: u32,
    place: Place,
    sensors: Sensors,
    /// Whether some effect is not one of the catalogue: it may depend on the change of the specific force.
    own: bool,
    /// Delay of the accelerometers, s.
    delay: f64,
    pub(crate) temperatures: Temperatures,
    temperature_every: u64,
    gyro_noise: Noise,
    accelerometer_noise: Noise,
    pub(crate) dither: Dither,
    reference: References,
}

#[derive(Clone, Debug)]
pub(crate) struct Dither {
    amplitudes: Option<Amplitudes>,
    full: Option<FullDither>,
    every: u64,
    reading_noise: f64,
    /// By how much the pick-offs read too large.
    scale: Vector3<f64>,
    noise: Stream,
}

#[derive(Clone, Debug)]
struct References {
    every: Option<u64>,
    attitude: bool,
    sigma: ReferenceSigma,
    delay: f64,
    misalignment: UnitQuaternion<f64>,
    tilt: UnitQuaternion<f64>,
    noise: Stream,
    attitude_noise: Stream,
}

impl Simulation {
    /// Unit `seed` of the scenario's population on its table.
    ///
    /// # Errors
    /// When the scenario cannot be simulated; one that was parsed can.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, ScenarioError> {
        scenario.check()?;
        let truth = scenario.unit(seed);
        let seed = Seed { unit: seed, run: scenario.run };
        // an interval of a stamped second lasts (1 + c) seconds
        let stretched = 1.0 + truth.value("clock-scale", 0);
        let dt = stretched / scenario.rate;
        let (motion, _) = scenario.motion.build(&scenario.table);
        let table = scenario.table;
        // the unit stands where it stands; what the log says of the site is another matter
        let site = Site {
            latitude: scenario.site.latitude + truth.value("site-latitude", 0),
            height: scenario.site.height + truth.value("site-height", 0),
            ..scenario.site
        };
        let place =
            Place::new(&site, truth.vector("outer-lever-arm")).heavier(truth.value("site-gravity", 0));
        let thermometers = [0, 1].map(|group| ThermometerErrors {
            lag: truth.value("thermometer-lag", group),
            scale: truth.value("thermometer-scale", group),
            offset: truth.value("thermometer-offset", group),
        });
        let effects = scenario.population.iter().map(|population| population.effect);
        let own = effects.clone().any(|effect| sinscal::effect(effect.name()).is_none());
        let sensors = Sensors::new(&truth, effects);
        let every = |part: f64| (scenario.rate / part).round().max(1.0) as u64;
        let (first, _) = table.apply(&motion, dt);
        let plan = &scenario.reference;
        let reference_attitude = plan.attitude_sigma.hypot(table.encoder_noise);
        let description = Description {
            rate: scenario.rate,
            site: scenario.site,
            initial: scenario.initial_attitude(first.attitude(), seed),
            reference: ReferenceSigma {
                velocity: plan.velocity_sigma,
                position: plan.position_sigma,
                attitude: reference_attitude,
            },
            readings: plan.readings,
            attitude: plan.readings && plan.attitude,
            noise: SensorNoise {
                angle_random_walk: scenario.gyro.white,
                velocity_random_walk: scenario.accelerometer.white,
            },
            wander: BiasWander {
                random_walk: [scenario.gyro.bias_walk(), scenario.accelerometer.bias_walk()],
                gauss_markov: [scenario.gyro.wander(), scenario.accelerometer.wander()],
            },
            reference_temperature: scenario.temperature.reference,
            outer_lever: scenario.initial.outer_lever,
            title: format!("{}unit {}, run {}", Description::MARK, seed.unit, seed.run),
            dither: scenario.dither.mode != DitherMode::Off,
            update_rate: if plan.readings { plan.rate } else { FIXED_POINT_RATE },
        };
        let tilt = Vector3::new(truth.value("reference-tilt", 0), truth.value("reference-tilt", 1), 0.0);
        let reference = References {
            every: plan.readings.then(|| every(plan.rate)),
            attitude: plan.attitude,
            sigma: description.reference,
            delay: truth.value("reference-delay", 0),
            misalignment: UnitQuaternion::from_scaled_axis(truth.vector("reference-misalignment")),
            tilt: UnitQuaternion::from_scaled_axis(-tilt),
            noise: Stream::in_run(seed, "noise/reference"),
            attitude_noise: Stream::in_run(seed, "noise/reference-attitude"),
        };
        Ok(Self {
            dt,
            rate: scenario.rate / stretched,
            clock: 1.0 / stretched,
            samples: scenario.samples(),
            next: 0,
            rigid: table.is_rigid(),
            panels: scenario.panels(),
            dither: Dither::new(scenario, &sensors, &truth.vector("dither-scale"), seed),
            temperatures: Temperatures::new(&scenario.temperature, thermometers, seed, dt),
            temperature_every: every(scenario.temperature.rate),
            gyro_noise: Noise::new(&scenario.gyro, seed, "gyro", dt),
            accelerometer_noise: Noise::new(&scenario.accelerometer, seed, "accelerometer", dt),
            delay: truth.value("accel-delay", 0),
            description: description.sound(),
            truth,
            motion,
            table,
            place,
            sensors,
            own,
            reference,
        })
    }

    /// The unit's true parameters. How far the biases have wandered and walked by the end stands there once the last sample
    /// was taken.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Takes down how far the biases have gone.
    fn note_wander(&mut self) {
        let wander = self.description.wander;
        let [gyro, accelerometer] = [self.gyro_noise.biases(), self.accelerometer_noise.biases()];
        let mut note = |stated: bool, effect: &'static EffectInfo, value: Vector3<f64>| {
            if stated {
                self.truth.insert(effect, value.iter().copied().collect());
            }
        };
        note(wander.gauss_markov[0].is_some(), const { &GyroBiasWander::EFFECT }, gyro[0]);
        note(wander.gauss_markov[1].is_some(), const { &AccelBiasWander::EFFECT }, accelerometer[0]);
        note(wander.random_walk[0].is_some(), const { &GyroBiasRandomWalk::EFFECT }, gyro[1]);
        note(wander.random_walk[1].is_some(), const { &AccelBiasRandomWalk::EFFECT }, accelerometer[1]);
    }

    /// What is known of the log.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Number of samples in the whole log.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// True rotation and motion of the centre of rotation at time `t`.
    pub fn motion(&self, t: f64) -> (Rotation, Centre) {
        if self.rigid { (self.motion.at(t), Centre::FIXED) } else { self.table.apply(&self.motion, t) }
    }

    /// True position (m) and velocity (m/s) of the unit's sensitive centre from the site origin in n at time `t`.
    pub fn position(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (rotation, centre) = self.motion(t);
        self.place.position(&rotation, &centre)
    }

    /// What an ideal unit in its place feels at time `t`.
    #[inline]
    pub fn felt(&self, t: f64) -> Felt {
        if self.rigid {
            self.place.felt(&self.motion.at(t), &Centre::FIXED)
        } else {
            let (rotation, centre) = self.table.apply(&self.motion, t);
            self.place.felt(&rotation, &centre)
        }
    }

    /// Derivative of the specific force in b at time `t`, m/s^3, by differences of fourth order.
    fn force_rate(&self, t: f64) -> Vector3<f64> {
        let slope = |h: f64| (self.felt(t + h).force - self.felt(t - h).force) / (2.0 * h);
        let h = 0.1 * self.dt;
        (slope(0.5 * h) * 4.0 - slope(h)) / 3.0
    }

    /// Integrals of what gyros and accelerometers read over interval `k`, without noise.
    fn increments(&self, k: u64, dither: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let start = k as f64 / self.rate;
        let (mut dtheta, mut dvel) = (Vector3::zeros(), Vector3::zeros());
        let temperature_rate = Vector3::repeat(self.temperatures.rate());
        let signals = |t: f64| {
            let felt = self.felt(t);
            let (temperature, gyro_temperature) = self.temperatures.at((t - start) / self.dt);
            Signals {
                rate: felt.rate,
                angular_acceleration: felt.angular_acceleration,
                force: felt.force,
                force_rate: if self.own { self.force_rate(t) } else { Vector3::zeros() },
                temperature,
                temperature_rate,
                gyro_temperature,
                dither: *dither,
                coupled_dither: *dither,
                // since the first sample, which ends the first interval
                time: t - self.dt,
                ..Signals::default()
            }
        };
        let part = self.dt / f64::from(self.panels);
        for panel in 0..self.panels {
            for (node, weight) in NODES {
                let t = start + (f64::from(panel) + node) * part;
                let now = signals(t);
                dtheta += self.sensors.gyros(&now) * weight;
                let felt = if self.delay == 0.0 {
                    now
                } else {
                    let earlier = t - self.delay;
                    signals(earlier)
                };
                dvel += self.sensors.accelerometers(felt) * weight;
            }
        }
        (dtheta * part, dvel * part)
    }

    /// What the errors of the reference depend on at time `t`.
    fn point(&self, t: f64) -> Point<f64> {
        self.seen(t).0
    }

    /// The same, and what an ideal unit feels there.
    pub(crate) fn seen(&self, t: f64) -> (Point<f64>, Felt) {
        let (rotation, centre) = self.motion(t);
        let (position, velocity) = self.place.position(&rotation, &centre);
        let felt = self.place.felt(&rotation, &centre);
        let site = self.description.site;
        let point = Point {
            c_bn: rotation.c_bn,
            velocity,
            latitude: site.latitude,
            height: site.height,
            position,
            force_n: rotation.c_bn * felt.force,
            rate_eb: rotation.rate,
            lever: self.place.lever,
            point_velocity: centre.velocity,
            point_acceleration: centre.acceleration,
            point_position: centre.position,
            ..Point::default()
        };
        (point, felt)
    }

    fn reference(&mut self, time: f64) -> Reference {
        let shown = time - self.reference.delay;
        let (rotation, centre) = self.motion(shown);
        let [velocity_error, position_error, attitude_error] = if self.sensors.reference_errs() {
            self.sensors.reference(&self.point(shown))
        } else {
            [Vector3::zeros(); 3]
        };
        let reference = &mut self.reference;
        let velocity = reference.noise.normals() * reference.sigma.velocity;
        let position = reference.noise.normals() * reference.sigma.position;
        let attitude = reference.attitude.then(|| {
            let noise = reference.attitude_noise.normals() * reference.sigma.attitude;
            reference.tilt
                // C_read = (I - [e x]) C
                * UnitQuaternion::from_scaled_axis(noise - attitude_error)
                * rotation.attitude()
                * reference.misalignment
        });
        Reference {
            velocity: Some(reference.tilt * centre.velocity + (velocity + velocity_error)),
            position: Some(reference.tilt * centre.position + (position + position_error)),
            attitude,
            ..Reference::default()
        }
    }
}

impl Dither {
    fn new(scenario: &Scenario, sensors: &Sensors, scale: &Vector3<f64>, seed: Seed) -> Self {
        let plan = &scenario.dither;
        let spread = Stream::new(seed.unit, "dither/amplitudes").normals();
        let mut random = Stream::in_run(seed, "dither/phases");
        let phase = Vector3::from_fn(|_, _| std::f64::consts::TAU * random.uniform());
        let amplitudes = (plan.mode != DitherMode::Off).then(|| Amplitudes {
            mean: plan.amplitude.component_mul(&(spread * plan.spread).add_scalar(1.0)),
            change: plan.change,
            period: plan.period,
            phase,
        });
        let full = amplitudes.as_ref().filter(|_| plan.mode == DitherMode::Full).map(|amplitudes| {
            let steps = (plan.simulation_rate / scenario.rate).round().max(1.0) as usize;
            FullDither::new(plan, amplitudes, sensors.arms(), steps, seed, 1.0 / scenario.rate)
        });
        Self {
            amplitudes,
            full,
            every: (scenario.rate / plan.rate).round().max(1.0) as u64,
            reading_noise: plan.reading_noise,
            scale: *scale,
            noise: Stream::in_run(seed, "noise/dither-readings"),
        }
    }

    /// Half the squares of the amplitudes at `time`, where the mean of the size effect is what counts.
    #[inline]
    fn mean_square(&self, time: f64) -> Vector3<f64> {
        if self.full.is_some() { Vector3::zeros() } else { self.expected(time) }
    }

    /// Half the squares of the amplitudes at `time`, however the dither is simulated.
    pub(crate) fn expected(&self, time: f64) -> Vector3<f64> {
        self.amplitudes.as_ref().map_or(Vector3::zeros(), |amplitudes| {
            let a = amplitudes.at(time);
            a.component_mul(&a) * 0.5
        })
    }

    fn read(&mut self, time: f64) -> Vector3<f64> {
        let noise = if self.reading_noise > 0.0 {
            self.noise.normals() * self.reading_noise
        } else {
            Vector3::zeros()
        };
        self.amplitudes.as_ref().map_or(Vector3::repeat(f64::NAN), |amplitudes| {
            let there = amplitudes.at(time);
            there + there.component_mul(&self.scale) + noise
        })
    }
}

impl Iterator for Simulation {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next >= self.samples {
            return None;
        }
        let k = self.next;
        self.next += 1;
        let time = self.next as f64 / self.rate;
        self.temperatures.advance(time);
        let middle = time - 0.5 * self.dt;
        let (mut dtheta, mut dvel) = self.increments(k, &self.dither.mean_square(middle));
        if let Some(mut full) = self.dither.full.take() {
            dvel += full.increment(k, |t| {
                let felt = self.felt(t - self.delay);
                (felt.rate, felt.angular_acceleration)
            });
            self.dither.full = Some(full);
        }
        self.gyro_noise.add(&mut dtheta);
        self.accelerometer_noise.add(&mut dvel);
        if self.next == self.samples {
            self.note_wander();
        }

        // readings stand in the first row and wherever their interval ends
        let due = |every: u64| k == 0 || (k + 1).is_multiple_of(every);
        let nothing = Vector3::repeat(f64::NAN);
        let (temperature, gyro_temperature) =
            if due(self.temperature_every) { self.temperatures.read() } else { (nothing, nothing) };
        let dither = if due(self.dither.every) { self.dither.read(time) } else { nothing };
        let reference = match self.reference.every {
            Some(every) if due(every) => self.reference(time),
            Some(_) => Reference::default(),
            // a fixed point is known at every row
            None => Reference {
                velocity: Some(Vector3::zeros()),
                position: Some(Vector3::zeros()),
                ..Reference::default()
            },
        };
        let time = time * self.clock;
        Some(Sample { time, dtheta, dvel, temperature, gyro_temperature, dither, reference })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = (self.samples - self.next) as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for Simulation {}
