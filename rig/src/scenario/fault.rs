//! What is wrong with a scenario, all of it at once.

use std::fmt;
use std::ops::Range;

/// One thing that is wrong with a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The field, for instance `motion.rate`.
    pub field: String,
    /// What is wrong with it.
    pub problem: String,
    /// What is accepted; empty where that says itself.
    pub accepted: String,
    /// Line in the scenario, from 1; none for a value that does not stand there.
    pub line: Option<usize>,
    /// Bytes of the text of the scenario it is about.
    pub span: Option<Range<usize>>,
}

/// So many faults found together are told: whoever mends a scenario begins with the first of them.
pub(super) const TOLD: usize = 20;

/// As many faults as are told, with a remark where there were more.
pub(super) fn told(mut faults: Vec<Fault>) -> Vec<Fault> {
    if faults.len() >= TOLD {
        faults.truncate(TOLD);
        faults.push(Fault::new("", "there may be more faults like these", ""));
    }
    faults
}

impl Fault {
    pub(crate) fn new(
        field: impl Into<String>,
        problem: impl Into<String>,
        accepted: impl Into<String>,
    ) -> Self {
        // a name out of a file may hold a line break
        let in_line = |text: String| text.replace('\r', "\\r").replace('\n', "\\n");
        Self {
            field: in_line(field.into()),
            problem: in_line(problem.into()),
            accepted: accepted.into(),
            line: None,
            span: None,
        }
    }

    pub(crate) fn at(mut self, text: &str, span: Range<usize>) -> Self {
        let before = text.as_bytes().get(..span.start).unwrap_or_default();
        self.line = Some(1 + before.iter().filter(|byte| **byte == b'\n').count());
        self.span = Some(span);
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if !self.field.is_empty() {
            write!(f, "{} ", self.field)?;
        }
        f.write_str(&self.problem)?;
        if !self.accepted.is_empty() {
            write!(f, "; accepted: {}", self.accepted)?;
        }
        Ok(())
    }
}

/// A scenario that cannot be simulated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n"))]
pub struct ScenarioError {
    /// Everything that is wrong, at least one.
    pub faults: Vec<Fault>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_a_name_does_not_break_the_message() {
        let fault = Fault::new("imu.a\nb", "is \"x\ny\"", "3 m");
        assert_eq!((fault.field.as_str(), fault.problem.as_str()), ("imu.a\\nb", "is \"x\\ny\""));
    }
}
