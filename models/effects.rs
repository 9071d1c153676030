//! The catalogue of effects: what a filter can be asked to model.

use calib_core::{Block, StateInfo};

use crate::blocks::*;
use crate::tables::{EffectTable, Kind};

/// A block that belongs to the catalogue.
pub trait Effect: Block {
    /// Its entry.
    const EFFECT: EffectInfo;
}

/// What the catalogue says about an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectInfo {
    /// The table its Jacobian is generated from: name, kind, components, unit, equation, description, source.
    pub table: EffectTable,
    /// Default prior standard deviation of each component, in the table's unit.
    pub prior_sigma: f64,
    /// Unit that data sheets use, for instance `ppm`.
    pub sheet_unit: &'static str,
    /// Size of one sheet unit in the table's unit.
    pub sheet_scale: f64,
}

impl EffectInfo {
    /// Name in declarations, reports and files, for instance `gyro-scale`.
    pub const fn name(&self) -> &'static str {
        self.table.name
    }

    /// Whether it is an error of the gyros, of the accelerometers or of the measurement.
    pub const fn kind(&self) -> Kind {
        self.table.kind
    }

    /// Names of its states.
    pub const fn components(&self) -> &'static [&'static str] {
        self.table.components
    }

    /// SI unit of its states.
    pub const fn unit(&self) -> &'static str {
        self.table.unit
    }

    /// The model in plain text.
    pub const fn equation(&self) -> &'static str {
        self.table.equation
    }

    /// One line about it.
    pub const fn description(&self) -> &'static str {
        self.table.description
    }

    /// Describes its states in order.
    pub fn states(&self, visit: &mut dyn FnMut(StateInfo)) {
        for component in self.components() {
            visit(StateInfo {
                block: self.name(),
                component,
                unit: self.unit(),
                prior_sigma: self.prior_sigma,
                sheet_unit: self.sheet_unit,
                sheet_scale: self.sheet_scale,
            });
        }
    }
}

/// Every effect.
pub static EFFECTS: [EffectInfo; 27] = [
    <GyroScale as Effect>::EFFECT,
    <GyroMisalignment as Effect>::EFFECT,
    <GyroBias as Effect>::EFFECT,
    <AccelScale as Effect>::EFFECT,
    <AccelMisalignment as Effect>::EFFECT,
    <AccelBias as Effect>::EFFECT,
    <AccelQuadratic as Effect>::EFFECT,
    <OuterLeverArm as Effect>::EFFECT,
    <InnerLeverArm as Effect>::EFFECT,
    <DitherSizeEffect as Effect>::EFFECT,
    <AccelDelay as Effect>::EFFECT,
    <AccelTemperatureScale as Effect>::EFFECT,
    <AccelTemperatureBias as Effect>::EFFECT,
    <AccelTemperatureRate as Effect>::EFFECT,
    <GyroTemperatureBias as Effect>::EFFECT,
    <GyroGSensitivity as Effect>::EFFECT,
    <AccelScaleAsymmetry as Effect>::EFFECT,
    <GyroScaleAsymmetry as Effect>::EFFECT,
    <AccelCubic as Effect>::EFFECT,
    <AccelCrossCoupling as Effect>::EFFECT,
    <GyroRateNonlinearity as Effect>::EFFECT,
    <AccelBiasDrift as Effect>::EFFECT,
    <GyroBiasDrift as Effect>::EFFECT,
    <InnerLeverArmTangential as Effect>::EFFECT,
    <ReferenceDelay as Effect>::EFFECT,
    <ReferenceMisalignment as Effect>::EFFECT,
    <ReferenceTilt as Effect>::EFFECT,
];

/// The effect of a name.
pub fn effect(name: &str) -> Option<&'static EffectInfo> {
    EFFECTS.iter().find(|effect| effect.name() == name)
}
