//! The rules across the fields of a declaration. Each function judges one field, or one name, or the whole.

use super::text::equal;
use super::{Part, Role, Text, meets};
use crate::{MeasurementInfo, Need, Relaxation};

/// What is wrong with the dynamics of a field, which `fit` those of the declaration, or do not.
pub const fn belongs(field: &str, family: &str, fit: bool) -> Text {
    if fit {
        return Text::EMPTY;
    }
    Text::EMPTY
        .with_name(field)
        .with(" is a block of other dynamics than the declaration, whose dynamics are ")
        .with_name(family)
        .with(": `#[filter(dynamics = ...)]` or `#[group(dynamics = ...)]` names them")
}

/// What is wrong with field `i` of a filter whose dynamics begin with `leading`.
pub const fn filter_field(parts: &[Part], i: usize, leading: &[Need]) -> Text {
    let mut text = forgets(repeats(parts, i), &parts[i]);
    if let Role::Base { declared: false } = parts[i].role {
        text = text
            .next()
            .with("`#[base] ")
            .with(parts[i].name)
            .with("` is not a declared filter: a base is a struct with `#[filter(...)]`, a group of blocks or a block needs no `#[base]`");
    }
    let mut k = 0;
    // what is no filter may have been meant to be the one that meets them
    while k < parts[i].needs.len() && !misbased(parts) {
        if !meets(parts, &parts[i].needs[k]) {
            text = if text.is_empty() { text.with_name(parts[i].name).with(": ") } else { text.next() };
            text = text.with(parts[i].needs[k].message);
        }
        k += 1;
    }
    if extends(parts) {
        return text;
    }
    let mut text = out_of_order(text, parts, i, leading);
    if parts[i].considered && leads(&parts[i], leading) {
        text = text.next().with_name(parts[i].name).with(
            " is considered, but leading states are what is navigated: `#[consider]` is for parameter blocks",
        );
    }
    if parts[i].relaxes() && leads(&parts[i], leading) {
        return text
            .next()
            .with_name(parts[i].name)
            .with(" forgets by itself, but leading states move as the dynamics say: `RELAXATIONS` are for parameter blocks");
    }
    text
}

/// What is wrong with field `i` of a group whose dynamics begin with `leading`.
pub const fn group_field(parts: &[Part], i: usize, leading: &[Need]) -> Text {
    let text = forgets(repeats(parts, i), &parts[i]);
    if i > 0 && leads(&parts[0], leading) != leads(&parts[i], leading) && parts[0].known && parts[i].known {
        return text
            .next()
            .with_name(parts[i].name)
            .with(" and ")
            .with_name(parts[0].name)
            .with(" in one group: a group is made of leading blocks only, or of parameter blocks only");
    }
    out_of_order(text, parts, i, leading)
}

/// What is wrong with a filter as a whole: leading blocks that are missing, or of the wrong size.
pub const fn filter(parts: &[Part], leading: &[Need], core: usize) -> Text {
    let mut text = Text::EMPTY;
    if extends(parts) {
        return text;
    }
    let mut k = 0;
    while k < leading.len() {
        if !meets(parts, &leading[k]) {
            text = text.next().with(leading[k].message);
        }
        k += 1;
    }
    if !text.is_empty() {
        return text;
    }
    if leading.is_empty() {
        return unnamed_core(parts, core);
    }
    let mut states = 0;
    let mut i = 0;
    while i < parts.len() {
        if !repeats(parts, i).is_empty() || parts[i].repeated {
            return text;
        }
        if leads(&parts[i], leading) {
            states += parts[i].dim;
        }
        i += 1;
    }
    if states == core { text } else { wrong_core(states, core) }
}

/// What is wrong with the measurement at place `k`, of dynamics that `fit` those of the declaration, or do not: two of one name could
/// not be told apart.
pub const fn measurement(measures: &[MeasurementInfo], k: usize, fit: bool) -> Text {
    if !fit {
        return Text::EMPTY.with("a measurement of other dynamics than the declaration");
    }
    let mut i = 0;
    while i < k {
        if !measures[k].components.is_empty() && equal(measures[i].name, measures[k].name) {
            return Text::EMPTY.with("two measurements with the name ").with_name(measures[k].name);
        }
        i += 1;
    }
    Text::EMPTY
}

/// Whether a base is no filter.
const fn misbased(parts: &[Part]) -> bool {
    let mut i = 0;
    while i < parts.len() {
        if let Role::Base { declared: false } = parts[i].role {
            return true;
        }
        i += 1;
    }
    false
}

/// Whether a base answers for the leading blocks, or a type that is not known might be one of them.
const fn extends(parts: &[Part]) -> bool {
    let mut i = 0;
    while i < parts.len() {
        if parts[i].is_base() || !parts[i].known {
            return true;
        }
        i += 1;
    }
    false
}

const fn repeats(parts: &[Part], i: usize) -> Text {
    if parts[i].repeated {
        return Text::EMPTY;
    }
    let mut j = 0;
    while j < i {
        if let Some((one, other)) = shared(&parts[j], &parts[i]) {
            let earlier = if parts[j].is_base() { "the base " } else { "" };
            if one.dim != other.dim {
                return Text::EMPTY
                    .with_name(parts[i].name)
                    .with(" declares a second block named ")
                    .with_name(one.block)
                    .with(", of ")
                    .with_number(other.dim)
                    .with(" states: that in ")
                    .with(earlier)
                    .with_name(parts[j].name)
                    .with(" has ")
                    .with_number(one.dim)
                    .with("; two blocks need two names");
            }
            return Text::EMPTY
                .with_name(parts[i].name)
                .with(" declares a block twice: ")
                .with_name(one.block)
                .with(" is already in ")
                .with(earlier)
                .with_name(parts[j].name)
                .with(" (two different blocks need two names)");
        }
        j += 1;
    }
    Text::EMPTY
}

/// Relaxations that no state of a block has, or that grow.
const fn forgets(text: Text, part: &Part) -> Text {
    let mut k = 0;
    while k < part.relaxations.len() {
        let (state, Relaxation { rate, density }) = part.relaxations[k];
        if state >= part.dim {
            return text
                .next()
                .with_name(part.name)
                .with(" gives state ")
                .with_number(state)
                .with(" a relaxation: its states are counted from 0 and there are ")
                .with_number(part.dim);
        }
        if !(rate >= 0.0 && density >= 0.0) {
            return text
                .next()
                .with_name(part.name)
                .with(" gives state ")
                .with_number(state)
                .with(" a relaxation that grows: its rate and its density are 0 or more");
        }
        k += 1;
    }
    text
}

/// The first block of `part` of whose name `other` has one too, and that one.
const fn shared(part: &Part, other: &Part) -> Option<(Part, Part)> {
    if !part.known {
        return None;
    }
    if part.parts.is_empty() {
        return match named(other, part.block) {
            Some(found) => Some((*part, found)),
            None => None,
        };
    }
    let mut i = 0;
    while i < part.parts.len() {
        let found = shared(&part.parts[i], other);
        if found.is_some() {
            return found;
        }
        i += 1;
    }
    None
}

/// The block called `name` within a part.
const fn named(part: &Part, name: &str) -> Option<Part> {
    if part.parts.is_empty() {
        return if part.has(name) { Some(*part) } else { None };
    }
    let mut i = 0;
    while i < part.parts.len() {
        let found = named(&part.parts[i], name);
        if found.is_some() {
            return found;
        }
        i += 1;
    }
    None
}

/// Whether a part holds a leading block.
const fn leads(part: &Part, leading: &[Need]) -> bool {
    let mut k = 0;
    while k < leading.len() {
        if meets(&[*part], &leading[k]) {
            return true;
        }
        k += 1;
    }
    false
}

/// Whether `later` holds a leading block that comes before every leading block of `part`.
const fn precedes(later: &Part, part: &Part, leading: &[Need]) -> bool {
    let mut k = 0;
    while k < leading.len() {
        if meets(&[*part], &leading[k]) {
            return false;
        }
        if meets(&[*later], &leading[k]) {
            return true;
        }
        k += 1;
    }
    false
}

/// A field before a leading block that comes before it: said of the first such field only.
const fn out_of_order(text: Text, parts: &[Part], i: usize, leading: &[Need]) -> Text {
    let mut k = 0;
    while k < i {
        if preceded(parts, k, leading) < parts.len() {
            return text;
        }
        k += 1;
    }
    let later = preceded(parts, i, leading);
    if later == parts.len() {
        return text;
    }
    text.next()
        .with_name(parts[i].name)
        .with(" stands too early: the leading block ")
        .with_name(parts[later].name)
        .with(" comes before it")
}

/// The first field that stands after field `i` and comes before it; the number of fields when none does.
const fn preceded(parts: &[Part], i: usize, leading: &[Need]) -> usize {
    let mut j = i + 1;
    while j < parts.len() {
        if precedes(&parts[j], &parts[i], leading) && !doubled(parts, i, j) {
            return j;
        }
        j += 1;
    }
    parts.len()
}

/// Whether one of two fields has been reported as standing there twice.
const fn doubled(parts: &[Part], i: usize, j: usize) -> bool {
    parts[i].repeated || parts[j].repeated || !repeats(parts, i).is_empty() || !repeats(parts, j).is_empty()
}

/// Dynamics that name no leading block: the first fields must make their states all the same.
const fn unnamed_core(parts: &[Part], core: usize) -> Text {
    let mut states = 0;
    let mut i = 0;
    while i < parts.len() && states < core {
        states += parts[i].dim;
        i += 1;
    }
    if states == core { Text::EMPTY } else { wrong_core(states, core) }
}

const fn wrong_core(states: usize, core: usize) -> Text {
    Text::EMPTY
        .with("the leading blocks make ")
        .with_number(states)
        .with(" states where these dynamics move ")
        .with_number(core)
}
