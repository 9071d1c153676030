//! `Extended` is what `#[base]` is, to the bit.

mod common;

use calib_core::Extended;
use common::{Numbers, sample, setup, signals};
use sinscal::{
    AccelTemperatureScale, Calibration, Conventional, Filter, Form, Sins40P, Sins43P, Strapdown, Ud,
};

fn parameters<F: Filter<Dynamics = Strapdown>, C: Form>() -> Vec<(String, u64, u64)> {
    let mut numbers = Numbers(5);
    let mut run = Calibration::<F, C>::new(&setup()).expect("a sound setup");
    for k in 0..1000 {
        let time = f64::from(k) * 0.01;
        let now = signals(time);
        let mut sample = sample(time, now.rate * 0.01, now.force * 0.01);
        sample.temperature = now.temperature.add_scalar(25.0);
        sample.reference.velocity = Some(numbers.vector(0.1));
        sample.reference.position = Some(numbers.vector(0.1));
        run.step(&sample).expect("the run converges");
    }
    let mut all = Vec::new();
    run.parameters(&mut |p| {
        all.push((format!("{} {}", p.info.block, p.info.component), p.value.to_bits(), p.sigma.to_bits()))
    });
    all
}

#[test]
fn a_grown_filter_equals_the_declared_one() {
    type Grown = Extended<Sins40P, AccelTemperatureScale>;
    let (grown, declared) = (parameters::<Grown, Conventional>(), parameters::<Sins43P, Conventional>());
    assert_eq!(grown.len(), 34);
    assert_eq!(grown, declared);
    assert_eq!(parameters::<Grown, Ud>(), parameters::<Sins43P, Ud>());
}
