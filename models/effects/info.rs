//! The entry of an effect.

use calib_core::StateInfo;

use crate::tables::EffectTable;

/// What an effect is an error of, and so which of its Jacobians it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Of the gyros.
    Rate,
    /// Of the accelerometers.
    Force,
    /// Of gyros and accelerometers, by the same parameters.
    Sensors,
    /// Of the reference.
    Measurement,
}

impl Kind {
    /// Whether the gyros' readings show it.
    pub const fn of_gyros(self) -> bool {
        matches!(self, Self::Rate | Self::Sensors)
    }

    /// Whether the accelerometers' readings show it.
    pub const fn of_accelerometers(self) -> bool {
        matches!(self, Self::Force | Self::Sensors)
    }
}

/// What people are told of an effect, and what it is worth before any measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectInfo {
    name: &'static str,
    kind: Kind,
    components: &'static [&'static str],
    unit: &'static str,
    equation: &'static str,
    description: &'static str,
    source: &'static str,
    kin: Option<&'static str>,
    units: [(&'static str, f64); 2],
    /// Default prior standard deviation of each component, in [`unit`](Self::unit).
    pub prior_sigma: f64,
    /// Unit that data sheets use, for instance `ppm`.
    pub sheet_unit: &'static str,
    /// Size of one sheet unit in [`unit`](Self::unit).
    pub sheet_scale: f64,
}

impl EffectInfo {
    /// An effect called `name`, an error of what `kind` says, with a state for each of `components` in the SI unit `unit` and the
    /// prior standard deviation `prior_sigma`. Sheets use the same unit unless [`sheet`](Self::sheet) says otherwise.
    pub const fn new(
        name: &'static str,
        kind: Kind,
        components: &'static [&'static str],
        unit: &'static str,
        prior_sigma: f64,
    ) -> Self {
        Self {
            name,
            kind,
            components,
            unit,
            equation: "",
            description: "",
            source: "",
            kin: None,
            units: [(unit, 1.0); 2],
            prior_sigma,
            sheet_unit: unit,
            sheet_scale: 1.0,
        }
    }

    /// What a generated table says.
    pub(crate) const fn tabled(table: &EffectTable, prior_sigma: f64) -> Self {
        let Some(kind) = table.kind else { panic!("a table of the dynamics is no effect") };
        Self::new(table.name, kind, table.components, table.unit, prior_sigma)
            .model(table.equation, table.description)
            .sourced(table.source)
    }

    /// With its equation in plain text and one line about it.
    #[must_use]
    pub const fn model(mut self, equation: &'static str, description: &'static str) -> Self {
        self.equation = equation;
        self.description = description;
        self
    }

    /// With where the model comes from.
    #[must_use]
    pub const fn sourced(mut self, source: &'static str) -> Self {
        self.source = source;
        self
    }

    /// With the unit of data sheets and the size of one of them in SI.
    #[must_use]
    pub const fn sheet(mut self, unit: &'static str, scale: f64) -> Self {
        self.units[1] = (unit, scale);
        self.sheet_unit = unit;
        self.sheet_scale = scale;
        self
    }

    /// With the effect that its size goes with: a unit whose biases are a thousand times those of a navigation-grade one has larger
    /// nonlinearities and temperature effects too.
    #[must_use]
    pub const fn akin_to(mut self, kin: &'static str) -> Self {
        self.kin = Some(kin);
        self
    }

    /// Name in declarations, reports and files, for instance `gyro-scale`.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// What it is an error of.
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// Names of its states.
    pub const fn components(&self) -> &'static [&'static str] {
        self.components
    }

    /// SI unit of its states.
    pub const fn unit(&self) -> &'static str {
        self.unit
    }

    /// Its SI unit and the unit of sheets, each with its size: what people may write of an effect whose unit nobody else has.
    pub const fn units(&self) -> &[(&'static str, f64)] {
        &self.units
    }

    /// The model in plain text.
    pub const fn equation(&self) -> &'static str {
        self.equation
    }

    /// One line about it.
    pub const fn description(&self) -> &'static str {
        self.description
    }

    /// Where the model comes from.
    pub const fn source(&self) -> &'static str {
        self.source
    }

    /// The effect that its size goes with.
    pub const fn kin(&self) -> Option<&'static str> {
        self.kin
    }

    /// Describes its states in order.
    pub fn states(&self, visit: &mut dyn FnMut(StateInfo)) {
        for component in self.components {
            visit(StateInfo {
                block: self.name,
                component,
                unit: self.unit,
                prior_sigma: self.prior_sigma,
                sheet_unit: self.sheet_unit,
                sheet_scale: self.sheet_scale,
            });
        }
    }
}
