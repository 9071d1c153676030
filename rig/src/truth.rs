//! The true parameters of a unit.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::Vector3;
use sinscal::{EffectInfo, StateInfo};

/// True parameters by effect, in the order of the effect's components, SI. Only what the unit has is listed.
///
/// `dither-size-effect` is there when the unit dithers, with the values of `inner-lever-arm`, through which it acts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    values: BTreeMap<&'static str, Vec<f64>>,
    components: BTreeMap<&'static str, &'static [&'static str]>,
}

impl Truth {
    /// Sets the parameters of an effect.
    pub fn insert(&mut self, effect: &'static EffectInfo, values: Vec<f64>) {
        self.values.insert(effect.name(), values);
        self.components.insert(effect.name(), effect.components());
    }

    /// Parameters by the names of the effects.
    pub fn effects(&self) -> &BTreeMap<&'static str, Vec<f64>> {
        &self.values
    }

    /// Component `i` of an effect; zero when the unit does not have it.
    pub fn value(&self, effect: &str, i: usize) -> f64 {
        self.values.get(effect).and_then(|values| values.get(i)).copied().unwrap_or(0.0)
    }

    /// An effect of three components; zero when the unit does not have it.
    pub fn vector(&self, effect: &str) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.value(effect, i))
    }

    /// The true value of a filter's parameter state; zero when the unit does not have the effect.
    pub fn of(&self, state: &StateInfo) -> f64 {
        let component = self
            .components
            .get(state.block)
            .and_then(|components| components.iter().position(|name| *name == state.component));
        component.map_or(0.0, |i| self.value(state.block, i))
    }

    /// The content of `NAME.truth.json`: an object of lists.
    pub fn to_json(&self) -> String {
        let mut text = String::from("{");
        for (i, (name, values)) in self.values.iter().enumerate() {
            let separator = if i == 0 { "" } else { "," };
            // writing to a string cannot fail
            let _ = write!(text, "{separator}\n  \"{name}\": [");
            for (j, value) in values.iter().enumerate() {
                let _ = write!(text, "{}{value:e}", if j == 0 { "" } else { ", " });
            }
            text.push(']');
        }
        text.push_str("\n}\n");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_lists_each_effect_in_the_order_of_its_components() {
        let mut truth = Truth::default();
        truth.insert(sinscal::effect("accel-delay").unwrap(), vec![4.95e-4]);
        truth.insert(sinscal::effect("gyro-scale").unwrap(), vec![1e-5, -2e-5, 0.0]);
        assert_eq!(
            truth.to_json(),
            "{\n  \"accel-delay\": [4.95e-4],\n  \"gyro-scale\": [1e-5, -2e-5, 0e0]\n}\n"
        );
    }
}
