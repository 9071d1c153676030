//! The scenario of a designed path.

use std::fmt::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Result};
use toml::{Table, Value};

use super::answer::Answer;

/// The scenario in a file, or the default one, with the path of a plan.
pub(super) fn scenario(base: Option<&Path>, answer: &Answer) -> Result<String> {
    let mut scenario: Table = match base {
        Some(path) => std::fs::read_to_string(path).into_diagnostic()?.parse().into_diagnostic()?,
        None => Table::new(),
    };
    let mut motion = match scenario.remove("motion") {
        Some(Value::Table(motion)) => motion,
        _ => Table::new(),
    };
    ["path", "still", "turns", "swing"].iter().for_each(|key| {
        motion.remove(*key);
    });
    let mut text = format!(
        "# Designed by `sinscal plan` for {}: {:.1} s, {} turns.\n\n[motion]\npath = \"turns\"\nstill = \"{} s\"\n",
        answer.filter(),
        answer.duration(),
        answer.turns().len(),
        answer.still()
    );
    text += &toml::to_string(&motion).into_diagnostic()?;
    text += "turns = [\n";
    for turn in answer.turns() {
        // writing to a string cannot fail
        let _ = writeln!(
            text,
            "  {{ axis = \"{}\", angle = \"{} deg\", rate = \"{} deg/s\", dwell = \"{} s\" }},",
            turn.axis, turn.angle_deg, turn.rate_deg_s, turn.dwell_s
        );
    }
    text += "]\n";
    if !scenario.is_empty() {
        text += "\n";
        text += &toml::to_string(&scenario).into_diagnostic()?;
    }
    Ok(text)
}
