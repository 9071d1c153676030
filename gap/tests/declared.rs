//! The declaration that a diagnosis writes is a filter like any other.

use gap::{BaseFilter, declaration};
use sinscal::prelude::*;

/// What `declaration` writes for the filter below; kept equal by the test.
const SOURCE: &str = "use sinscal::prelude::*;

/// 36d-p with inner-lever-arm, dither-size-effect, accel-delay.
#[derive(Debug, StateBlocks)]
#[filter(name = \"36d-p-inner-lever-arm-dither-size-effect-accel-delay\", measures(velocity, position))]
pub struct Sins36PInnerLeverArmDitherSizeEffectAccelDelay {
    #[base]
    base: sinscal::Sins36P,
    inner_lever_arm: InnerLeverArm,
    dither: Dither,
    accel_delay: AccelDelay,
}
";

/// 36d-p with inner-lever-arm, dither-size-effect, accel-delay.
#[derive(Debug, StateBlocks)]
#[filter(name = "36d-p-inner-lever-arm-dither-size-effect-accel-delay", measures(velocity, position))]
pub struct Sins36PInnerLeverArmDitherSizeEffectAccelDelay {
    #[base]
    base: sinscal::Sins36P,
    inner_lever_arm: InnerLeverArm,
    dither: Dither,
    accel_delay: AccelDelay,
}

#[test]
fn what_is_written_compiles_and_runs() {
    let base = BaseFilter {
        name: "36d-p".into(),
        path: "sinscal::Sins36P".into(),
        measures: vec!["velocity".into(), "position".into()],
        has_inner_lever_arm: false,
    };
    assert_eq!(declaration(&base, &["inner-lever-arm", "dither-size-effect", "accel-delay"]), SOURCE);
    type Filter = Sins36PInnerLeverArmDitherSizeEffectAccelDelay;
    assert_eq!(Filter::DIM, 40);
    let scenario = rig::Scenario::parse("[motion]\npath = \"still\"\nduration = \"60 s\"").unwrap();
    let simulation = rig::Simulation::new(&scenario, 1).unwrap();
    let setup = simulation.description().setup(&[]);
    let mut calibration = Calibration::<Filter>::new(&setup).expect("a sound setup");
    for sample in simulation {
        calibration.step(&sample).unwrap();
    }
    assert!((calibration.statistics().nis_per_dof() - 1.0).abs() < 0.3);
}
