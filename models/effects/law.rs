//! Effects whose equation is data.

use core::any::TypeId;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use calib_core::{Block as _, Relaxation, StateInfo};

use super::term::{Motion, Term};
use super::{AnyBlock, AnyEffect, Effect as _, EffectInfo, Kind};
use crate::{AccelBias, FORCE, GyroBias, Point, RATE, Signals};

/// A sensor error as a product of what was measured, with a coefficient for each axis: `d_f_i = k_i (dT_i/dt)^2`. It says how an error
/// goes, and never why.
///
/// - Where: what a diagnosis proposes for an effect that is in no library, and any filter may have by its name, like an effect.
/// - Equation: `d_f_i = k_i ...` or `d_omega_i = k_i ...`; i is the sensor's own axis, j and k are the next two.
/// - Unit: that of the error over that of the product, SI.
/// - Source: none; the error is linear in k, so that its Jacobian is the product itself.
///
/// The name says everything: `accel-bias-by-` or `gyro-bias-by-`, then the factors, joined by `-times-`.
///
/// ```
/// use sinscal::Law;
///
/// let law = Law::named("accel-bias-by-temperature-rate-squared").expect("a law");
/// assert_eq!((&*law.equation(), &*law.unit()), ("d_f_i = k_i (dT_i/dt)^2", "m/s^2/(K/s)^2"));
/// assert_eq!(law.effect().dim(), 3);
/// assert!(Law::named("accel-bias-by-the-moon").is_none());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Law {
    kind: Kind,
    term: Term,
}

impl Law {
    /// Every law of gyros or accelerometers: products of rates, forces, temperature and its rate up to the third degree, and of sizes,
    /// time and dither up to the second.
    pub fn all(of_gyros: bool) -> Vec<Self> {
        let kind = if of_gyros { Kind::Rate } else { Kind::Force };
        Term::all().into_iter().map(|term| Self { kind, term }).collect()
    }

    /// The law called `name`.
    pub fn named(name: &str) -> Option<Self> {
        let (bias, _) = name.split_once("-by-")?;
        let of_gyros = bias == GyroBias::NAME;
        let known = of_gyros || bias == AccelBias::NAME;
        Self::all(of_gyros).into_iter().find(|law| known && law.name() == name)
    }

    /// What it is an error of: [`Kind::Rate`] or [`Kind::Force`].
    pub fn kind(&self) -> Kind {
        self.kind
    }

    fn is_gyro(&self) -> bool {
        self.kind == Kind::Rate
    }

    /// The bias that it changes.
    fn bias(&self) -> &'static EffectInfo {
        if self.is_gyro() { const { &GyroBias::EFFECT } } else { const { &AccelBias::EFFECT } }
    }

    /// Name, which says what it goes with.
    pub fn name(&self) -> String {
        format!("{}-by-{}", self.bias().name(), self.term.words())
    }

    /// In plain text.
    pub fn equation(&self) -> String {
        let error = if self.is_gyro() { "d_omega_i" } else { "d_f_i" };
        format!("{error} = k_i {}", self.term.formula())
    }

    /// SI unit of its coefficients.
    pub fn unit(&self) -> String {
        self.term.unit(self.bias().unit())
    }

    /// The product for the sensor of axis `i`, SI.
    pub fn value(&self, motion: &Motion, i: usize) -> f64 {
        self.term.value(motion, self.is_gyro(), i)
    }

    /// The product as a block in Rust has it: an expression of `signals` and the axis `i`.
    pub fn code(&self) -> String {
        self.term.code(self.is_gyro())
    }

    /// It as an effect, with the standard deviation that makes where everything it goes with is large what is expected of the bias.
    /// The same law is the same object, and stays for as long as the program runs.
    pub fn effect(&self) -> &'static dyn AnyEffect {
        static KNOWN: Mutex<BTreeMap<String, &'static Data>> = Mutex::new(BTreeMap::new());
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        *known.entry(self.name()).or_insert_with_key(|name| self.data(name))
    }

    /// The object, for ever.
    fn data(&self, name: &str) -> &'static Data {
        let kept = |text: String| -> &'static str { text.leak() };
        let prior = self.bias().prior_sigma / self.term.large();
        let components = &["x", "y", "z"];
        let unit = kept(self.unit());
        // the power of a thousand that makes numbers of what is expected
        let decades = 3 * ((prior.log10().floor() as i32 - 1).div_euclid(3));
        let (sheet, scale) = match decades {
            0 => (unit, 1.0),
            _ => (kept(format!("1e{decades} {unit}")), 10_f64.powi(decades)),
        };
        let info = EffectInfo::new(kept(name.to_owned()), self.kind, components, unit, prior)
            .sheet(sheet, scale)
            .model(kept(self.equation()), "a law of what was measured: how an error goes, and not why")
            .akin_to(self.bias().name());
        Box::leak(Box::new(Data { law: self.clone(), info: Box::leak(Box::new(info)) }))
    }
}

/// A law as an object.
struct Data {
    law: Law,
    info: &'static EffectInfo,
}

impl AnyBlock for Data {
    fn dim(&self) -> usize {
        self.info.components().len()
    }

    fn states(&self, visit: &mut dyn FnMut(StateInfo)) {
        self.info.states(visit);
    }

    fn input_jacobian(&self, signals: &Signals<f64>, put: &mut dyn FnMut(usize, usize, f64)) {
        let motion = Motion::from(signals);
        let first = if self.law.is_gyro() { RATE } else { FORCE };
        for i in 0..3 {
            put(first + i, i, self.law.value(&motion, i));
        }
    }

    fn measurement_jacobian(&self, _: &Point<f64>, _: &mut dyn FnMut(usize, usize, f64)) {}

    fn relaxation(&self, _: &mut dyn FnMut(usize, Relaxation<f64>)) {}
}

impl AnyEffect for Data {
    fn info(&self) -> &'static EffectInfo {
        self.info
    }

    fn id(&self) -> TypeId {
        TypeId::of::<Self>()
    }

    fn block(&'static self) -> &'static dyn AnyBlock {
        self
    }

    fn error(&self, signals: &Signals<f64>, values: &[f64], error: &mut [f64; 6]) {
        self.input_jacobian(signals, &mut |input, state, value| error[input] += value * values[state]);
    }

    fn reference_error(&self, _: &Point<f64>, _: &[f64], _: &mut [f64; 9]) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_found_by_its_name_and_is_one_object() {
        for law in [false, true].into_iter().flat_map(Law::all) {
            let name = law.name();
            assert_eq!(Law::named(&name), Some(law.clone()), "{name}");
            let effect = law.effect();
            assert!(core::ptr::eq(effect, law.effect()), "{name}");
            assert_eq!((effect.name(), effect.info().equation()), (&*name, &*law.equation()));
            let info = effect.info();
            assert!(info.prior_sigma > 0.0 && info.kind() == law.kind());
            let expected = info.prior_sigma / info.sheet_scale;
            assert!((9.0..1e4).contains(&expected), "{name}: {expected} {}", info.sheet_unit);
        }
        assert_eq!(Law::named("accel-scale-by-temperature"), None);
        assert_eq!(Law::named("accel-bias"), None);
    }

    /// A coefficient of the prior's size makes, where everything is large, as much as is expected of the bias.
    #[test]
    fn the_jacobian_is_the_product_on_the_own_axis() {
        let signals = Signals {
            rate: [0.1, -0.2, 0.3].into(),
            force: [1.0, 2.0, -9.0].into(),
            temperature: [4.0, 5.0, 6.0].into(),
            gyro_temperature_rate: [0.01, 0.02, 0.03].into(),
            ..Signals::default()
        };
        let entries = |name: &str| {
            let mut entries = Vec::new();
            let law = Law::named(name).expect("a law");
            law.effect()
                .input_jacobian(&signals, &mut |input, state, value| entries.push((input, state, value)));
            let mut error = [0.0; 6];
            law.effect().error(&signals, &[1.0, 10.0, 100.0], &mut error);
            for (input, state, value) in &entries {
                assert_eq!(error[*input], value * [1.0, 10.0, 100.0][*state]);
            }
            entries
        };
        let by_force = entries("accel-bias-by-temperature-times-force-j-squared");
        assert_eq!(by_force, [(3, 0, 4.0 * 4.0), (4, 1, 5.0 * 81.0), (5, 2, 6.0 * 1.0)]);
        let by_rate = entries("gyro-bias-by-temperature-rate-squared");
        for (i, (input, state, value)) in by_rate.into_iter().enumerate() {
            assert_eq!((input, state), (RATE + i, i));
            assert!((value - signals.gyro_temperature_rate[i].powi(2)).abs() < 1e-18);
        }
    }
}
