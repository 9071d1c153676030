//! The same numbers in four forms. Names follow the vocabulary of effects, `gyro-scale x` as `GYRO_SCALE_X`.

use std::fmt::Write;

use super::read::Calibration;

/// A number that every one of the languages reads back to the same bits: shortest digits, always a point, a sign in the
/// exponent (without which YAML 1.1 takes it for text).
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        return format!("{value:?}");
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = if digits.contains('.') { digits.to_owned() } else { format!("{digits}.0") };
    match exponent.strip_prefix('-') {
        Some(exponent) => format!("{digits}e-{exponent:0>2}"),
        None => format!("{digits}e+{exponent:0>2}"),
    }
}

/// What every file begins with, line by line.
fn preamble(calibration: &Calibration) -> Vec<String> {
    let mut lines = vec![
        concat!("Calibration of an inertial unit, written by sinscal ", env!("CARGO_PKG_VERSION")).to_owned(),
        String::new(),
    ];
    lines.extend(calibration.source.iter().cloned());
    lines.extend(
        [
            "",
            "Axes: b, right-forward-up. Units: SI, angles in rad, temperatures in degC. Sigma: one standard deviation.",
            "The error of a sensor is measured - true, so that compensation subtracts it:",
            "    omega = omega_measured - d_omega",
            "    f     = f_measured - d_f",
            "where d_omega (rad/s) and d_f (m/s^2) are the sums of the lines so called at the effects below. They are taken at",
            "the true omega and f: begin with the measured ones and repeat, two rounds for scale errors of 1e-3, four for 3 %.",
            "j, k: the axes other than i; A_i: amplitude of the dither's rate about i (rad/s); T_i, T_gi: temperature of",
            "accelerometer and gyro i; t: time since the start (s); C: from b to east-north-up.",
            "Only what was estimated stands here; whatever is not there counts as zero.",
        ]
        .map(str::to_owned),
    );
    if calibration.effects.iter().any(|(effect, _)| effect.equation().contains("T_ref"))
        && calibration.reference_temperature.is_none()
    {
        lines.push(
            "T_ref is temperature.reference_c of the log's description, 25 degC if that does not say.".into(),
        );
    }
    if calibration.effects.iter().any(|(effect, _)| effect.equation().contains("A_j")) && !calibration.dither
    {
        lines.push("This filter does not model dither: A is zero in the equations.".into());
    }
    lines
}

/// An effect in words: name, what it is, equation.
fn heading(effect: &sinscal::EffectInfo) -> Vec<String> {
    vec![format!("{}: {}", effect.name(), effect.description()), format!("    {}", effect.equation())]
}

/// Numbers that belong together: lines about them, then name, value and unit of each.
type Group = (Vec<String>, Vec<(String, f64, String)>);

/// Every number, effect by effect.
fn constants(calibration: &Calibration) -> Vec<Group> {
    let mut groups = Vec::new();
    if let Some(reference) = calibration.reference_temperature {
        let entry = ("reference-temperature".to_owned(), reference, "degC".to_owned());
        groups.push((vec!["T_ref, where the temperature effects vanish".to_owned()], vec![entry]));
    }
    for (name, unit, sizes) in &calibration.pulses {
        let entries = ["x", "y", "z"].into_iter().zip(sizes);
        let entries = entries.map(|(axis, size)| (format!("{name}-{axis}"), *size, (*unit).to_owned()));
        groups.push((vec![format!("{name}: the increment that one pulse stands for")], entries.collect()));
    }
    for (effect, estimates) in &calibration.effects {
        let mut entries = Vec::new();
        for estimate in estimates {
            let name = format!("{}-{}", effect.name(), estimate.component);
            let name = name.trim_end_matches('-').to_owned();
            entries.push((name.clone(), estimate.value, effect.unit().to_owned()));
            entries.push((name + "-sigma", estimate.sigma, effect.unit().to_owned()));
        }
        groups.push((heading(effect), entries));
    }
    groups
}

/// Text of lines, each after a prefix, without spaces at their ends.
fn lines(text: &mut String, prefix: &str, lines: &[String]) {
    for line in lines {
        text.push_str(format!("{prefix}{line}").trim_end());
        text.push('\n');
    }
}

/// A header for C and C++.
pub(super) fn c(calibration: &Calibration) -> String {
    let mut text = String::from("/*\n");
    lines(&mut text, " * ", &preamble(calibration));
    text.push_str(" */\n#ifndef SINSCAL_CALIBRATION_H\n#define SINSCAL_CALIBRATION_H\n");
    for (heading, entries) in constants(calibration) {
        text.push_str("\n/*\n");
        lines(&mut text, " * ", &heading);
        text.push_str(" */\n");
        for (name, value, unit) in entries {
            let name = name.to_ascii_uppercase().replace('-', "_");
            let _ = writeln!(text, "#define SINSCAL_{name} ({}) /* {unit} */", number(value));
        }
    }
    text + "\n#endif\n"
}

/// A module for Rust, without dependencies and for `no_std` too.
pub(super) fn rust(calibration: &Calibration) -> String {
    let mut text = String::new();
    lines(&mut text, "// ", &preamble(calibration));
    for (heading, entries) in constants(calibration) {
        text.push('\n');
        lines(&mut text, "// ", &heading);
        for (name, value, unit) in entries {
            let shown = name.replace('-', " ");
            let name = name.to_ascii_uppercase().replace('-', "_");
            let _ = writeln!(text, "/// {shown}, {unit}");
            let _ = writeln!(text, "pub const {name}: f64 = {};", number(value));
        }
    }
    text
}

/// A script for MATLAB and Octave.
pub(super) fn matlab(calibration: &Calibration) -> String {
    let mut text = String::new();
    lines(&mut text, "% ", &preamble(calibration));
    text.push_str("\ncalibration = struct();\n");
    let _ = writeln!(text, "calibration.filter = '{}';", calibration.filter);
    for (heading, entries) in constants(calibration) {
        text.push('\n');
        lines(&mut text, "% ", &heading);
        for (name, value, unit) in entries {
            let _ = writeln!(text, "calibration.{} = {}; % {unit}", name.replace('-', "_"), number(value));
        }
    }
    text
}

/// YAML: the parameters by effect, and what Kalibr calls M and bias.
pub(super) fn yaml(calibration: &Calibration) -> String {
    let mut text = String::new();
    lines(&mut text, "# ", &preamble(calibration));
    let _ = writeln!(text, "\nfilter: {}", calibration.filter);
    if let Some(reference) = calibration.reference_temperature {
        let _ = writeln!(text, "reference_temperature_c: {}", number(reference));
    }
    for (name, unit, sizes) in &calibration.pulses {
        let sizes = sizes.map(number).join(", ");
        let _ = writeln!(text, "{name}: {{unit: {unit}, size: [{sizes}]}}");
    }
    text.push_str(
        "imu0: # measured = M true + bias, as Kalibr writes it; the other parameters stand below\n",
    );
    for (sensor, short, unit) in [("gyroscopes", "gyro", "rad/s"), ("accelerometers", "accel", "m/s^2")] {
        let of = |effect: &str, component: &str| {
            calibration.value(&format!("{short}-{effect}"), component).unwrap_or_default()
        };
        let row = |row: &str| {
            let entry = |column: &str| match row == column {
                true => number(1.0 + of("scale", row)),
                false => number(of("misalignment", &format!("{row}{column}"))),
            };
            ["x", "y", "z"].map(entry).join(", ")
        };
        let _ = writeln!(text, "  {sensor}:\n    M:");
        for axis in ["x", "y", "z"] {
            let _ = writeln!(text, "    - [{}]", row(axis));
        }
        let bias = ["x", "y", "z"].map(|axis| number(of("bias", axis))).join(", ");
        let _ = writeln!(text, "    bias: [{bias}] # {unit}");
    }
    text.push_str("parameters:\n");
    for (effect, estimates) in &calibration.effects {
        lines(&mut text, "  # ", &heading(effect));
        let _ = writeln!(text, "  {}:\n    unit: \"{}\"", effect.name(), effect.unit());
        for estimate in estimates {
            let component = if estimate.component.is_empty() { "value" } else { &estimate.component };
            let (value, sigma) = (number(estimate.value), number(estimate.sigma));
            // y is true in YAML 1.1
            let _ = writeln!(text, "    \"{component}\": {{value: {value}, sigma: {sigma}}}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_read_back_to_the_bit(value in any::<f64>().prop_filter("finite", |value| value.is_finite())) {
            let text = number(value);
            prop_assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
            prop_assert!(text.contains('.'));
        }
    }

    #[test]
    fn numbers_are_written_for_every_language() {
        let written = [0.0, 25.0, -7e-6, 1.5e300, 0.125].map(number);
        assert_eq!(written, ["0.0", "25.0", "-7.0e-06", "1.5e+300", "0.125"]);
    }
}
