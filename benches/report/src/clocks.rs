//! Where the time of a cycle goes: samples of `perf`, by the function of `calib-core` they fall into.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::Section;
use crate::plots;
use crate::run::{Error, Place, output, require, table};

/// Cycles that are sampled.
const CYCLES: u32 = 1_000_000;
/// Parts that take less of a cycle are not told apart.
const LEAST: f64 = 0.01;
const OTHERS: &str = "others";

/// The module and item of `calib-core` that a function's name begins with: what is generic has its parameters
/// after it.
fn item(function: &str) -> Option<(&str, &str)> {
    let path = function.trim_start_matches('<').strip_prefix("calib_core::")?;
    let (module, rest) = path.split_once("::")?;
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
    Some((module, &rest[..end]))
}

/// What kernels call in the system's library, by what its names contain there.
const CALLED: [(&str, &str); 4] = [
    ("memset", "zeros (memset)"),
    ("memmove", "copies (memcpy)"),
    ("memcpy", "copies (memcpy)"),
    ("log", "logarithms (ln)"),
];

/// Which part of a cycle a sample belongs to, by its symbol and by the functions that were inlined around it, the innermost
/// first: the kernel, and the innermost function in it that is not one of the tools all kernels use.
fn part<'a>(symbol: &str, functions: impl DoubleEndedIterator<Item = &'a str>) -> String {
    let tools = ["tile", "machine"];
    let mut items = functions.filter_map(item).filter(|(module, _)| !tools.contains(module));
    let innermost = items.next();
    let kernel = items.rfind(|(_, name)| ["propagate", "update"].contains(name));
    match (kernel, innermost) {
        (Some((_, kernel)), Some((_, name))) if kernel != name => format!("{kernel}: {name}"),
        (_, Some((_, name))) => format!("{name} itself"),
        (_, None) => {
            let called = CALLED.iter().find(|(name, _)| symbol.contains(name));
            called.map_or(OTHERS, |(_, name)| name).to_owned()
        }
    }
}

/// Names of the functions around each address, the innermost first.
fn functions(program: &Path, addresses: &[&str]) -> Result<Vec<Vec<String>>, Error> {
    let mut command = Command::new("addr2line");
    command.args(["-a", "-f", "-i", "-C", "-e"]).arg(program).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn()?;
    if let Some(mut input) = child.stdin.take() {
        let text = addresses.join("\n") + "\n";
        std::thread::spawn(move || input.write_all(text.as_bytes()));
    }
    let text = child.wait_with_output()?.stdout;
    let mut found: Vec<Vec<String>> = Vec::new();
    let mut name = true;
    for line in String::from_utf8_lossy(&text).lines() {
        if line.starts_with("0x") {
            found.push(Vec::new());
            name = true;
            continue;
        }
        if let (true, Some(last)) = (name, found.last_mut()) {
            last.push(line.to_owned());
        }
        name = !name;
    }
    Ok(found)
}

/// Shares of the parts of a cycle, and how long it takes, us.
fn shares(place: &Place, program: &Path, form: &str) -> Result<(Vec<(String, f64)>, f64), Error> {
    let mut time = f64::INFINITY;
    let few = CYCLES / 10;
    for _ in 0..20 {
        let begin = Instant::now();
        output(place.command(program).args([form, &few.to_string()]))?;
        time = time.min(begin.elapsed().as_secs_f64() * 1e6 / f64::from(few));
    }
    let data = place.target("clocks/perf.data");
    let mut record = place.command("perf");
    record.args(["record", "--quiet", "--event", "cpu-clock", "--freq", "4000", "--output"]).arg(&data);
    output(record.arg(program).args([form, &CYCLES.to_string()]))?;
    let text = output(place.command("perf").args(["script", "--fields", "ip,sym", "--input"]).arg(&data))?;
    // address and symbol of each sample
    let mut counts: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    for sample in text.lines().filter_map(|line| line.trim().split_once(' ')) {
        *counts.entry(sample).or_default() += 1.0;
    }
    let addresses: Vec<&str> = counts.keys().map(|(address, _)| *address).collect();
    let all: f64 = counts.values().sum();
    let mut shares: BTreeMap<String, f64> = BTreeMap::new();
    for (functions, ((_, symbol), count)) in functions(program, &addresses)?.iter().zip(&counts) {
        *shares.entry(part(symbol, functions.iter().map(String::as_str))).or_default() += count / all;
    }
    let small = |name: &str, share: f64| name == OTHERS || share < LEAST;
    let rest = shares.iter().filter(|(name, share)| small(name, **share)).map(|(_, share)| share).sum();
    shares.retain(|name, share| !small(name, *share));
    let mut shares: Vec<_> = shares.into_iter().collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares.push((OTHERS.to_owned(), rest));
    Ok((shares, time))
}

/// Where the time of a cycle goes, in both forms.
pub(crate) fn clocks(place: &Place) -> Result<Vec<Section>, Error> {
    require("perf")?;
    require("addr2line")?;
    // addresses in the file are those of the process: the program is not moved in memory
    place.cargo_in(
        "clocks",
        false,
        "rustc --quiet --manifest-path benches/counted/Cargo.toml --profile sampled -- -C relocation-model=static",
    )?;
    let program = place.target("clocks/sampled/counted");
    let mut rows = Vec::new();
    for (form, file, title) in [("conventional", "clocks", "conventional"), ("ud", "clocks-ud", "UD")] {
        let (shares, time) = shares(place, &program, form)?;
        let bars: Vec<(String, Vec<f64>)> =
            shares.iter().map(|(name, share)| (name.clone(), vec![share * time])).collect();
        let title_of_plot = format!("Where the {time:.2} us of a cycle go, {title}");
        plots::bars(place, file, (&title_of_plot, "time, us", false), &["time"], &bars)?;
        for (name, share) in &shares {
            let share_of = format!("{:.1}", 100.0 * share);
            rows.push(vec![title.to_owned(), name.clone(), share_of, format!("{:.2}", share * time)]);
        }
        rows.push(vec![title.to_owned(), "all".to_owned(), "100".to_owned(), format!("{time:.2}")]);
    }
    Ok(vec![("clocks", table(&["form", "function", "%", "us"], &rows))])
}
