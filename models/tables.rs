//! The generated Jacobians, one module per table of `models/tables`.

use calib_core::Real;

use crate::{Kind, Point, Signals};

/// What a table says about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectTable {
    /// Name of the effect or model, for instance `gyro-scale`.
    pub name: &'static str,
    /// What the effect is an error of; `None` for a matrix of the strapdown error model itself.
    pub kind: Option<Kind>,
    /// One line about it.
    pub description: &'static str,
    /// The model in plain text.
    pub equation: &'static str,
    /// Where the model comes from.
    pub source: &'static str,
    /// Version of SymPy that derived it.
    pub sympy: &'static str,
    /// SI unit of the parameters; empty without parameters.
    pub unit: &'static str,
    /// Names of the parameters; empty without parameters.
    pub components: &'static [&'static str],
    /// Fields of `Signals` or `Point` that it depends on, for instance `rate.x`.
    pub inputs: &'static [&'static str],
    /// Rows of the Jacobian: sensor inputs, measurement channels or leading states.
    pub rows: usize,
    /// Columns of the Jacobian.
    pub columns: usize,
    /// Entries that are not structural zeros.
    pub nonzeros: usize,
    /// What one evaluation costs.
    pub operations: Operations,
}

/// Arithmetic of one evaluation; a change of sign costs nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub add: u32,
    /// Multiplications.
    pub multiply: u32,
    /// Divisions.
    pub divide: u32,
    /// Elementary functions.
    pub function: u32,
}

include!(concat!(env!("OUT_DIR"), "/tables.rs"));
