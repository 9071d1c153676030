//! Text put together at compile time.

const CAPACITY: usize = 1024;

/// A message, empty when there is nothing to say.
pub struct Text {
    bytes: [u8; CAPACITY],
    len: usize,
}

impl Text {
    pub(super) const EMPTY: Self = Self { bytes: [0; CAPACITY], len: 0 };

    /// Whether there is nothing to say.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The message.
    pub const fn as_str(&self) -> &str {
        match core::str::from_utf8(self.bytes.split_at(self.len).0) {
            Ok(text) => text,
            Err(_) => "this declaration breaks a rule",
        }
    }

    /// Appends `part`, or nothing of it when it does not fit.
    pub(super) const fn with(mut self, part: &str) -> Self {
        let bytes = part.as_bytes();
        if self.len + bytes.len() <= CAPACITY {
            let mut i = 0;
            while i < bytes.len() {
                self.bytes[self.len + i] = bytes[i];
                i += 1;
            }
            self.len += bytes.len();
        }
        self
    }

    /// Appends a name in backquotes.
    pub(super) const fn with_name(self, name: &str) -> Self {
        self.with("`").with(name).with("`")
    }

    /// Appends a number.
    pub(super) const fn with_number(self, number: usize) -> Self {
        let rest = if number >= 10 { self.with_number(number / 10) } else { self };
        let digit = [b'0' + (number % 10) as u8];
        match core::str::from_utf8(&digit) {
            Ok(digit) => rest.with(digit),
            Err(_) => rest,
        }
    }

    /// Begins another sentence after an earlier one.
    pub(super) const fn next(self) -> Self {
        if self.is_empty() { self } else { self.with("; ") }
    }
}

/// Whether `a` and `b` are the same text.
pub(super) const fn equal(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}

/// Edits that turn `a` into `b`; no less than the longer length for names of 32 bytes or more.
pub const fn distance(a: &str, b: &str) -> usize {
    const LIMIT: usize = 32;
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() >= LIMIT || b.len() >= LIMIT {
        return if a.len() > b.len() { a.len() } else { b.len() };
    }
    let mut row = [0; LIMIT];
    let mut j = 0;
    while j <= b.len() {
        row[j] = j;
        j += 1;
    }
    let mut i = 0;
    while i < a.len() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        let mut j = 0;
        while j < b.len() {
            let replaced = diagonal + (a[i] != b[j]) as usize;
            diagonal = row[j + 1];
            let inserted = (if row[j] < diagonal { row[j] } else { diagonal }) + 1;
            row[j + 1] = if replaced < inserted { replaced } else { inserted };
            j += 1;
        }
        i += 1;
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_put_together() {
        const TEXT: Text = Text::EMPTY.next().with_name("gyro").with(" has ").with_number(1204).next();
        assert_eq!(TEXT.as_str(), "`gyro` has 1204; ");
    }

    #[test]
    fn what_does_not_fit_is_left_out() {
        let mut text = Text::EMPTY;
        for _ in 0..300 {
            text = text.with("\u{3bb}abc");
        }
        assert_eq!(text.as_str().len(), CAPACITY / 5 * 5);
    }

    #[test]
    fn edits_are_counted() {
        assert_eq!(distance("velocity", "velocity"), 0);
        assert_eq!(distance("velocty", "velocity"), 1);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert!(equal("a", "a") && !equal("a", "b") && !equal("a", "ab"));
    }
}
