//! For someone whose problem is not inertial: a target with constant velocity, seen by a radar whose zero drifts.
//!
//! The dynamics, the blocks and the measurement are all declared here; the filter is the same machinery.
//! Run it with `cargo run --release --example track_a_target`.

use sinscal::prelude::*;

/// Position and velocity east and north; nothing else acts on the target.
struct ConstantVelocity;

impl Dynamics for ConstantVelocity {
    const CORE: usize = 4;
    const INPUTS: usize = 0;
    const CHANNELS: usize = 2;
    const NEEDS: &'static [Need] = &[];
    type Signals<T: Real> = ();
    type Point<T: Real> = ();

    fn core_jacobian<T: Real>((): &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 2, T::one());
        put(1, 3, T::one());
    }
    fn inject<T: Real>((): &(), _: usize, _: T, _: &mut impl FnMut(usize, T)) {}
    fn measurement_jacobian<T: Real>((): &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, T::one());
        put(1, 1, T::one());
    }
}

/// What the radar shows: position, which is the channels as they are.
struct Plot;

impl Measurement for Plot {
    type Dynamics = ConstantVelocity;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "plot",
        components: &["e", "n"],
        unit: "m",
        columns: &[],
        sigma: 3.0,
        channels: Some(0),
    };
}

/// What all blocks of this example share: two components, a name, a prior.
macro_rules! planar {
    ($block:ident, $name:literal, $unit:literal, $sigma:literal, {$($more:item)*}) => {
        struct $block;
        impl Block for $block {
            type Dynamics = ConstantVelocity;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = $name;
            const DIM: usize = 2;
            fn states(visit: &mut dyn FnMut(StateInfo)) {
                for component in ["e", "n"] {
                    visit(StateInfo {
                        block: Self::NAME, component, unit: $unit, prior_sigma: $sigma, sheet_unit: $unit, sheet_scale: 1.0,
                    });
                }
            }
            $($more)*
        }
    };
}

planar!(TargetPosition, "target-position", "m", 1000.0, {});
planar!(TargetVelocity, "target-velocity", "m/s", 30.0, {});
planar!(RadarZero, "radar-zero", "m", 20.0, {
    // forgets within 200 s; the density keeps its standard deviation at 20 m
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[
        (0, Relaxation { rate: 1.0 / 200.0, density: 2.0 * 400.0 / 200.0 }),
        (1, Relaxation { rate: 1.0 / 200.0, density: 2.0 * 400.0 / 200.0 }),
    ];
    // a parameter state is truth - estimate: a zero not yet removed makes the plot read more, the residual less
    fn measurement_jacobian<T: Real>((): &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, -T::one());
        put(1, 1, -T::one());
    }
});

#[derive(StateBlocks)]
#[filter(dynamics = ConstantVelocity, measures(Plot))]
struct Tracker {
    position: TargetPosition,
    velocity: TargetVelocity,
    zero: RadarZero,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    assert_eq!(Tracker::DIM, 6);
    let mut kalman = Kalman::<Tracker>::new(&Kalman::<Tracker>::prior());
    let mut transition = Transition::new();
    let acceleration = 0.05_f64; // m/s^2 / sqrt(Hz): how far the target is from constant velocity
    let density = [0.0, 0.0, acceleration.powi(2), acceleration.powi(2)];

    // the truth starts at (300, -200) m with (12, 5) m/s; the filter's estimate at zero. The states are errors of the
    // estimate, computed - truth, so the residual of "nothing" against a plot is minus the plot.
    for second in 0..120 {
        let t = f64::from(second);
        let plot = [300.0 + 12.0 * t + 3.0 * (0.9 * t).sin(), -200.0 + 5.0 * t + 3.0 * (1.7 * t).cos()];
        let mut residuals = Residuals::<Tracker, f64>::default();
        for row in 0..2 {
            residuals.set(row, -plot[row], Plot::INFO.sigma);
        }
        let found = kalman.update(&(), &(), residuals, None)?;
        if second % 30 == 0 {
            let p = kalman.covariance();
            let view = Tracker::view(kalman.x(), &p);
            let (position, velocity) = (view.position(), view.velocity());
            println!(
                "{second:4} s  at ({:7.1}, {:7.1}) m +- {:4.1}   moving ({:5.2}, {:5.2}) m/s +- {:4.2}   NIS {:.2}",
                -position.values()[0],
                -position.values()[1],
                position.sigma(0),
                -velocity.values()[0],
                -velocity.values()[1],
                velocity.sigma(0),
                found.nis
            );
        }
        transition.reset();
        transition.advance(&(), 1.0);
        kalman.predict(&transition, &density);
    }
    Ok(())
}
