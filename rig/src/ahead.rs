//! A motion before it is made: what error models will depend on, at instants of one's own choice.

use nalgebra::Vector3;
use sinscal::{Point, Signals};

use crate::Simulation;

/// A simulation that is asked for true signals in place of samples. Times are to be asked for in their order.
#[derive(Clone, Debug)]
pub struct Ahead {
    simulation: Simulation,
    last: f64,
}

impl Ahead {
    /// Of the motion and the surroundings of a simulation, of which no sample is taken; from time zero on.
    pub fn new(simulation: Simulation) -> Self {
        Self { simulation, last: 0.0 }
    }

    /// Where the unit will be at time `t`, and what ideal sensors will feel there. Dither is felt by its mean square.
    pub fn at(&mut self, t: f64) -> (Point<f64>, Signals<f64>) {
        let simulation = &mut self.simulation;
        if t > self.last {
            simulation.temperatures.advance_over(t, t - self.last);
            self.last = t;
        }
        let (point, felt) = simulation.seen(t);
        let (temperature, gyro_temperature) = simulation.temperatures.at(1.0);
        let dither = simulation.dither.expected(t);
        let signals = Signals {
            rate: felt.rate,
            angular_acceleration: felt.angular_acceleration,
            force: felt.force,
            force_rate: felt.force.cross(&felt.rate),
            temperature,
            temperature_rate: Vector3::repeat(simulation.temperatures.rate()),
            gyro_temperature,
            dither,
            coupled_dither: dither,
            time: t,
            ..Signals::default()
        };
        (point, signals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;

    #[test]
    fn signals_are_those_that_the_samples_hold() -> Result<(), crate::ScenarioError> {
        // a sample holds the mean over its interval, which is what is felt in the middle of a short one
        let mut scenario = Scenario::default().with_rate(1000.0)?;
        scenario.motion.still = 5.0;
        scenario.population.clear();
        (scenario.gyro.white, scenario.accelerometer.white) = (0.0, 0.0);
        (scenario.gyro.quantum, scenario.accelerometer.quantum) = (0.0, 0.0);
        let simulation = Simulation::new(&scenario, 1)?;
        let mut ahead = Ahead::new(simulation.clone());
        let dt = 1.0 / scenario.rate;
        // five seconds of rest, and the first turn
        for sample in simulation.take(12_000) {
            let (point, signals) = ahead.at(sample.time - 0.5 * dt);
            assert!((sample.dtheta / dt - signals.rate).norm() < 1e-5);
            assert!((sample.dvel / dt - signals.force).norm() < 2e-3);
            assert!((point.force_n.z - 9.79).abs() < 0.1);
            if !sample.temperature.x.is_nan() {
                assert!((sample.temperature.x - 25.0 - signals.temperature.x).abs() < 1e-3);
            }
        }
        Ok(())
    }
}
