//! The nearest valid name to a mistyped one.

/// The candidate closest to `name`, if one is close enough to be what was meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = simplified(name);
    let length = wanted.chars().count();
    let allowed = (length / 2).max(1);
    let far = |candidate: &str| {
        let candidate = simplified(candidate);
        // A beginning of a name is a short form of it, however much is left out.
        let beginning = length >= 3 && candidate.starts_with(&wanted) && candidate != wanted;
        if beginning { 1 } else { distance(&wanted, &candidate) }
    };
    candidates
        .into_iter()
        .map(|candidate| (far(candidate), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// `did you mean ...`, or all the names when none is near.
pub fn hint<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(name, candidates.clone()) {
        Some(candidate) => format!("did you mean `{candidate}`?"),
        None => format!("valid names: {}", each(candidates).join(", ")),
    }
}

/// All the names, and the one that was meant if one is near: what follows `accepted:`.
pub fn accepted<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let all = each(candidates.clone()).join(", ");
    match nearest(name, candidates) {
        Some(near) => format!("{all} (did you mean `{near}`?)"),
        None => all,
    }
}

/// Every name once.
fn each<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut each = Vec::new();
    for name in names {
        if !each.contains(&name) {
            each.push(name);
        }
    }
    each
}

/// Lower case, one spelling of the separators, at most as long as any name of the program could be.
fn simplified(name: &str) -> String {
    name.chars()
        .take(64)
        .map(|c| if matches!(c, '-' | ' ' | '.') { '_' } else { c.to_ascii_lowercase() })
        .collect()
}

/// Levenshtein distance: insertions, deletions and replacements from one to the other.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", "abc"), 0);
    }

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let names = ["gyro-bias", "gyro-scale", "accel-bias"];
        assert_eq!(nearest("gyro_bias", names), Some("gyro-bias"));
        assert_eq!(nearest("Gyro-Scal", names), Some("gyro-scale"));
        assert_eq!(nearest("acel-bias", names), Some("accel-bias"));
        assert_eq!(nearest("accel", names), Some("accel-bias"));
        assert_eq!(nearest("TEMP_Y", ["temp_x", "temp_y"]), Some("temp_y"));
        assert_eq!(nearest("zzz", names), None);
        assert_eq!(hint("zzz", ["a_long_name"]), "valid names: a_long_name");
        assert_eq!(
            hint("zzz", ["gyro-scale", "gyro-scale", "gyro-bias"]),
            "valid names: gyro-scale, gyro-bias"
        );
    }
}
