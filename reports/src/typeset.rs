//! Texts as a page shows them: proper signs where plain text has to do with ASCII. Text output and files keep the ASCII.

use std::fmt::Write as _;

/// What units are made of.
const ATOMS: [&str; 24] = [
    "ug", "mg", "g", "deg", "rad", "arcsec", "h", "min", "s", "ms", "us", "ns", "m", "mm", "km", "K", "degC",
    "ppm", "Hz", "kHz", "sqrt", "nmi", "mrad", "urad",
];
/// Greek letters by their names in equations.
const GREEK: [(&str, &str); 9] = [
    ("omega", "ω"),
    ("eps", "ε"),
    ("tau", "τ"),
    ("delta", "δ"),
    ("theta", "θ"),
    ("phi", "φ"),
    ("sigma", "σ"),
    ("alpha", "α"),
    ("lambda", "λ"),
];

/// A text with proper signs: plus or minus, minus before numbers, units.
pub(crate) fn symbols(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for piece in text.split_inclusive(char::is_whitespace) {
        let word = piece.trim_end();
        let (head, core) = word.split_at(word.len() - word.trim_start_matches(['(', '[', '"']).len());
        let mut end = core.trim_end_matches([',', ';', ':', '.', ']', '"']).len();
        if core[..end].ends_with(')') && core.matches(')').count() > core.matches('(').count() {
            end -= 1;
        }
        let (core, tail) = core.split_at(end);
        out += head;
        out += &self::word(core);
        out += tail;
        out += &piece[word.len()..];
    }
    out
}

fn word(word: &str) -> String {
    let sign = match word {
        "+-" => Some("±"),
        "<=" => Some("≤"),
        ">=" => Some("≥"),
        "-log10" => Some("−log₁₀"),
        "log10" => Some("log₁₀"),
        _ => None,
    };
    if let Some(sign) = sign {
        return sign.into();
    }
    if let Some(number) = word.strip_prefix('-').filter(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    {
        return format!("−{}", number.replace("e-", "e−"));
    }
    unit(word).unwrap_or_else(|| word.to_owned())
}

/// A unit with its proper signs; nothing for what is no unit.
fn unit(word: &str) -> Option<String> {
    let atoms = word.split(|c: char| !c.is_ascii_alphabetic()).filter(|atom| !atom.is_empty());
    let others = word.chars().filter(|c| !c.is_ascii_alphabetic());
    let is_one = atoms.clone().count() > 0
        && atoms.clone().all(|atom| ATOMS.contains(&atom))
        && others.clone().all(|c| "/()^234".contains(c))
        && word.starts_with(|c: char| c.is_ascii_alphabetic());
    if !is_one {
        return None;
    }
    let mut out = String::new();
    let mut rest = word;
    while let Some(first) = rest.chars().next() {
        let length = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let (atom, after) = rest.split_at(length);
        // an angle alone is told in letters: "3 deg" reads better than a sign that is easily lost
        out += match atom {
            "ug" => "µg",
            "us" => "µs",
            "urad" => "µrad",
            "degC" => "°C",
            "deg" if after.starts_with('/') => "°",
            "sqrt" => "√",
            atom => atom,
        };
        rest = after;
        if length == 0 {
            match (first, rest.chars().nth(1)) {
                ('^', Some(power @ '2'..='4')) => {
                    out.push(['²', '³', '⁴'][power as usize - '2' as usize]);
                    rest = &rest[2..];
                }
                _ => {
                    out.push(first);
                    rest = &rest[first.len_utf8()..];
                }
            }
        }
    }
    // a root of one thing needs no brackets
    for atom in ["h", "Hz", "s"] {
        out = out.replace(&format!("√({atom})"), &format!("√{atom}"));
    }
    Some(out)
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// An equation in the plain text of the catalogue, such as `d_f_i = k_i f_i^2`, as HTML.
pub(crate) fn equation(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    // whether something stands before that could be multiplied
    let mut operand = false;
    while let Some(c) = rest.chars().next() {
        if c.is_ascii_alphabetic() {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            let (name, after) = rest.split_at(end);
            // a cross stands between two things, or last in the brackets of a matrix
            let crosses = match after.strip_prefix(' ') {
                Some(next) => next.starts_with(|c: char| c.is_ascii_alphabetic() || c == '('),
                None => after.starts_with(']'),
            };
            if name == "x" && operand && crosses {
                out += "×";
                operand = false;
            } else {
                identifier(name, &mut out);
                operand = true;
            }
            rest = after;
            continue;
        }
        rest = &rest[c.len_utf8()..];
        match c {
            '-' => out += "−",
            '\'' => out += "′",
            '!' if rest.starts_with('=') => {
                out += "≠";
                rest = &rest[1..];
            }
            '^' => {
                let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
                let _ = write!(out, "<sup>{}</sup>", &rest[..end]);
                rest = &rest[end..];
            }
            '.' if out.ends_with(' ') && rest.starts_with(' ') => out += "·",
            other => out += &escaped(&other.to_string()),
        }
        if !c.is_whitespace() {
            operand = c == ')' || c == ']' || c == '\'' || c.is_ascii_digit();
        }
    }
    out
}

/// A name in an equation: Greek letters, what stands below the line, an error of something.
fn identifier(name: &str, out: &mut String) {
    let (error, name) = match name.strip_prefix("d_") {
        Some(of) => ("δ", of),
        None => ("", name),
    };
    let mut parts = name.split('_');
    let base = parts.next().unwrap_or_default();
    let greek = |word: &str| GREEK.iter().find(|(name, _)| *name == word).map(|(_, letter)| *letter);
    *out += error;
    match (greek(base), base) {
        (Some(letter), _) => *out += &format!("<i>{letter}</i>"),
        // words are words, and so are differentials
        (None, "dt") => *out += "d<i>t</i>",
        (None, "dT") => *out += "d<i>T</i>",
        (None, word) if word.len() > 2 || ["of", "to"].contains(&word) => *out += &escaped(word),
        (None, letters) => *out += &format!("<i>{}</i>", escaped(letters)),
    }
    let below: Vec<&str> = parts.map(|part| greek(part).unwrap_or(part)).collect();
    if !below.is_empty() {
        let _ = write!(out, "<sub>{}</sub>", escaped(&below.join(",")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_proper_signs() {
        for (plain, shown) in [
            ("37.7 +- 1.1 mm", "37.7 ± 1.1 mm"),
            ("-32.77 to -30.91", "−32.77 to −30.91"),
            ("(-5 ug, at most)", "(−5 µg, at most)"),
            ("ug/g^2", "µg/g²"),
            ("noise, ug/sqrt(Hz)", "noise, µg/√Hz"),
            ("85 ug/(K/min)", "85 µg/(K/min)"),
            ("rate, deg/s", "rate, °/s"),
            ("0.05 deg/h/K", "0.05 °/h/K"),
            ("force, m/s^2", "force, m/s²"),
            ("2 m/s^3.", "2 m/s³."),
            ("20 degC", "20 °C"),
            ("-log10 p before", "−log₁₀ p before"),
            ("turns by 3 deg", "turns by 3 deg"),
            ("Ljung-Box p = -1e-7", "Ljung-Box p = −1e−7"),
        ] {
            assert_eq!(symbols(plain), shown);
        }
    }

    #[test]
    fn names_and_paths_stay() {
        for text in [
            "runs/ug-3.parquet",
            "gyro-scale x",
            "--filter 43d-b",
            "a  b\n c",
            "debug/ug",
            "",
            "s^5",
            "(",
            "x-2",
        ] {
            assert_eq!(symbols(text), text);
        }
    }

    #[test]
    fn equations_are_set() {
        for (plain, set) in [
            (
                "d_f_i = k_i f_i^2",
                "δ<i>f</i><sub>i</sub> = <i>k</i><sub>i</sub> <i>f</i><sub>i</sub><sup>2</sup>",
            ),
            ("d_omega_i = eps_i", "δ<i>ω</i><sub>i</sub> = <i>ε</i><sub>i</sub>"),
            ("omega x r", "<i>ω</i> × <i>r</i>"),
            ("I + [m x]", "<i>I</i> + [<i>m</i> ×]"),
            ("reading(t) = x(t - tau)", "reading(<i>t</i>) = <i>x</i>(<i>t</i> − <i>τ</i>)"),
            ("j != i", "<i>j</i> ≠ <i>i</i>"),
            ("dT_i/dt", "d<i>T</i><sub>i</sub>/d<i>t</i>"),
            ("u_i . r", "<i>u</i><sub>i</sub> · <i>r</i>"),
            (
                "(omega x (omega x r_i) + omega' x r_i)",
                "(<i>ω</i> × (<i>ω</i> × <i>r</i><sub>i</sub>) + <i>ω</i>′ × <i>r</i><sub>i</sub>)",
            ),
            (
                "x_ref = (I - [tilt x]) x; y",
                "<i>x</i><sub>ref</sub> = (<i>I</i> − [tilt ×]) <i>x</i>; <i>y</i>",
            ),
            ("a < b & <img>", "<i>a</i> &lt; <i>b</i> &amp; &lt;img&gt;"),
        ] {
            assert_eq!(equation(plain), set, "{plain}");
        }
    }
}
