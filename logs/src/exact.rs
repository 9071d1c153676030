//! Times that have more digits than a number of 53 bits: counted from an origin before they are rounded.

use chrono::{DateTime, NaiveDateTime, NaiveTime, Timelike};

/// Powers of ten beyond which a text is no time.
const LARGEST_POWER: i32 = 30;
/// Digits of a time.
const MOST_DIGITS: usize = 36;

/// The decimal number `text` less `origin`, rounded once it is small.
pub(super) fn since(text: &str, origin: i64) -> Option<f64> {
    let (negative, unsigned) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (mantissa, power) = match unsigned.split_once(['e', 'E']) {
        Some((mantissa, power)) => (mantissa, power.parse::<i32>().ok()?),
        None => (unsigned, 0),
    };
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = [whole, part].concat();
    let is_number = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
    if !is_number || digits.len() > MOST_DIGITS || power.abs() > LARGEST_POWER {
        // NaN, infinity, and what is no number
        return text.parse::<f64>().ok().map(|value| value - origin as f64);
    }
    // the decimal point, moved by the power of ten
    let point = whole.len() as i32 + power;
    let (whole, part) = match usize::try_from(point) {
        Ok(point) if point <= digits.len() => (digits[..point].to_owned(), digits[point..].to_owned()),
        Ok(point) => (format!("{digits:0<point$}"), String::new()),
        Err(_) => (String::new(), format!("{}{digits}", "0".repeat(point.unsigned_abs() as usize))),
    };
    let whole: i128 = if whole.is_empty() { 0 } else { whole.parse().ok()? };
    let part: f64 = if part.is_empty() { 0.0 } else { format!("0.{part}").parse().ok()? };
    let (whole, part) = if negative { (-whole, -part) } else { (whole, part) };
    Some(whole.checked_sub(origin.into())? as f64 + part)
}

/// How dates and times of a day are written; a zone is that of no concern within a log.
const DATES: [&str; 4] =
    ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f", "%d.%m.%Y %H:%M:%S%.f"];

/// The date or time of a day `text` less `origin`, s since 1970 or since midnight.
pub(super) fn date_since(text: &str, origin: i64) -> Option<f64> {
    let (seconds, nanos) = if let Ok(time) = DateTime::parse_from_rfc3339(text) {
        (time.timestamp(), time.timestamp_subsec_nanos())
    } else if let Some(time) = DATES.iter().find_map(|form| NaiveDateTime::parse_from_str(text, form).ok()) {
        (time.and_utc().timestamp(), time.and_utc().timestamp_subsec_nanos())
    } else {
        let time = NaiveTime::parse_from_str(text, "%H:%M:%S%.f").ok()?;
        (i64::from(time.num_seconds_from_midnight()), time.nanosecond())
    };
    Some(seconds.checked_sub(origin)? as f64 + f64::from(nanos) * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_seconds() {
        for text in [
            "2023-11-14T22:13:20.005Z",
            "2023-11-14T22:13:20.005",
            "2023-11-14 22:13:20.005",
            "2023/11/14 22:13:20.005",
            "14.11.2023 22:13:20.005",
            "2023-11-14T23:13:20.005+01:00",
        ] {
            assert_eq!(date_since(text, 1_700_000_000), Some(0.005), "{text}");
        }
        assert_eq!(date_since("10:22:33.12", 0), Some(37_353.12));
        for text in ["", "1700000000", "2023-13-14T22:13:20", "10:61:00", "2023-11-14"] {
            assert_eq!(date_since(text, 0), None, "{text}");
        }
    }

    #[test]
    fn digits_beyond_those_of_a_double_are_kept() {
        assert_eq!(since("1403636579808555392", 1_403_636_579_000_000_000), Some(808_555_392.0));
        assert_eq!(since("1700000000.005000", 1_700_000_000), Some(0.005));
        assert_eq!(since("1.700000000005e+09", 1_700_000_000), Some(0.005));
        assert_eq!(since("17000000000.05e-1", 1_700_000_000), Some(0.005));
        assert_eq!(since("-0.25", 1), Some(-1.25));
        assert_eq!(since("17e8", 1_700_000_000), Some(0.0));
        assert_eq!(since("5e-3", 0), Some(0.005));
        assert!(since("nan", 5).is_some_and(f64::is_nan));
        for text in ["", "x", "1.2.3", "--1", ".", "1e", "00:00:01"] {
            assert_eq!(since(text, 0), None, "{text}");
        }
    }
}
