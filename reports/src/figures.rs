//! Numbers as people read them.

/// Decimals that show two figures of a number.
pub fn decimals(number: f64) -> usize {
    if number > 0.0 && number.is_finite() {
        (1.0 - number.log10().floor()).clamp(0.0, 12.0) as usize
    } else {
        2
    }
}

/// A number to about three figures.
pub fn significant(number: f64) -> String {
    let digits = (decimals(number) + 1).min(12);
    let text = format!("{number:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures() {
        assert_eq!(decimals(0.0123), 3);
        assert_eq!(decimals(12.3), 0);
        assert_eq!(decimals(f64::NAN), 2);
        assert_eq!(significant(300.0), "300");
        assert_eq!(significant(206.2648), "206.3");
        assert_eq!(significant(0.05), "0.05");
        assert_eq!(significant(1.0 / 3.0), "0.333");
    }
}
