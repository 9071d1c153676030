//! The parts: what each runs, and the tables made of it.

use std::time::Instant;

use crate::Section;
use crate::plots;
use crate::run::{Error, Place, Times, grouped, numbers, output, require, short, table};

/// Which machine this is, and how busy.
pub(crate) fn machine(place: &Place) -> Result<Vec<Section>, Error> {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let cpu = read("/proc/cpuinfo");
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("a processor that does not tell its name", |(_, name)| name);
    let processors = std::thread::available_parallelism()?;
    let avx512 = if cpu.contains("avx512f") { "with AVX-512" } else { "without AVX-512" };
    let busy = read("/proc/loadavg");
    let busy = busy.split(' ').next().unwrap_or("unknown");
    let compiler = output(place.command("rustc").arg("--version"))?;
    let compiler = compiler.split(" (").next().unwrap_or_default().trim();
    let line =
        format!("{model}, {avx512}, {processors} processors; {compiler}; load {busy} at the beginning.");
    Ok(vec![("machine", line)])
}

/// What the benchmark of a cycle times besides cycles.
const ASSEMBLY: [&str; 5] = [
    "a sample absorbed into [Phi Psi]",
    "[Phi Psi] through a step of the dynamics",
    "process noise of an interval",
    "measurement matrix",
    "a sample of navigation",
];

/// A name with the formulas in it set as such.
fn as_code(name: &str) -> String {
    ["(I - K H) P", "[Phi Psi]"]
        .iter()
        .fold(name.to_owned(), |name, formula| name.replace(formula, &format!("`{formula}`")))
}

/// Cycles of all peers, and what is assembled for ours: in a default and in a native build.
pub(crate) fn cycle(place: &Place) -> Result<Vec<Section>, Error> {
    let run = |folder, native| {
        place.cargo_in(folder, native, "bench --quiet --manifest-path benches/peers/Cargo.toml -- --least")
    };
    let (default, native) = (run("peers", false)?, run("peers-native", true)?);
    let (default, native) = (Times::read(&default), Times::read(&native));
    let ours = [default.of("conventional")?, native.of("conventional")?];
    let mut cycles = Vec::new();
    for (name, time) in default.iter().filter(|(name, _)| !ASSEMBLY.contains(name)) {
        cycles.push((name, [time, native.of(name)?]));
    }
    cycles.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let row = |(name, times): &(&str, [f64; 2])| {
        let pair = |i: usize| [short(times[i]), format!("{:.1}", times[i] / ours[i])];
        [vec![as_code(name)], [0, 1].map(pair).concat()].concat()
    };
    let head = ["", "default, us", "relative", "`target-cpu=native`, us", "relative"];
    let ratios =
        |(name, times): &(&str, [f64; 2])| ((*name).to_owned(), vec![times[0] / ours[0], times[1] / ours[1]]);
    plots::bars(
        place,
        "peers",
        ("One cycle of 43 states", "time relative to the conventional form in the same run", true),
        &["default build", "target-cpu=native"],
        &cycles.iter().skip(1).map(ratios).collect::<Vec<_>>(),
    )?;
    let mut assembly = Vec::new();
    for name in ASSEMBLY {
        assembly.push(vec![as_code(name), short(default.of(name)?), short(native.of(name)?)]);
    }
    Ok(vec![
        ("cycle", table(&head, &cycles.iter().map(row).collect::<Vec<_>>())),
        ("assembly", table(&["", "default, us", "`target-cpu=native`, us"], &assembly)),
    ])
}

/// How a cycle grows: time and instructions.
pub(crate) fn growth(place: &Place) -> Result<Vec<Section>, Error> {
    require("valgrind")?;
    let times = Times::read(&place.cargo("bench --quiet --bench growth -- --least")?);
    let counted = output(place.command("bash").args(["benches/instructions.sh", "growth"]))?;
    let (mut states, mut measurements) = (Vec::new(), Vec::new());
    let mut curves = [const { Vec::new() }; 5];
    for line in counted.lines() {
        let [n, m, conventional_count, ud_count] = numbers(line)[..] else {
            return Err(format!("not understood: {line}").into());
        };
        let of = |form: &str| times.of(&format!("{form} {n} {m}"));
        let (conventional, ud) = (of("conventional")?, of("ud")?);
        let pair = [short(conventional), short(ud), format!("{:.2}", ud / conventional)];
        let counts =
            [grouped(conventional_count), grouped(ud_count), format!("{:.2}", ud_count / conventional_count)];
        if m == 6.0 {
            let nalgebra = of("nalgebra")?;
            for (curve, time) in curves.iter_mut().zip([conventional, ud, nalgebra]) {
                curve.push((n, time));
            }
            states
                .push([vec![format!("{n}")], pair.to_vec(), vec![short(nalgebra)], counts.to_vec()].concat());
        }
        if n == 43.0 {
            curves[3].push((m, conventional));
            curves[4].push((m, ud));
            measurements.push([vec![format!("{m}")], pair.to_vec(), counts.to_vec()].concat());
        }
    }
    let by_measurements = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
    curves[3].sort_by(by_measurements);
    curves[4].sort_by(by_measurements);
    measurements.sort_by_key(|row| row[0].clone());
    let [conventional, ud, nalgebra, conventional_m, ud_m] = curves;
    plots::curves(
        place,
        "states",
        ("A cycle with 6 measurements", "states, 9 of them leading", "time, us"),
        &[("conventional", conventional), ("UD", ud), ("nalgebra, nine rows by hand", nalgebra)],
    )?;
    plots::curves(
        place,
        "measurements",
        ("A cycle of 43 states", "measurements", "time, us"),
        &[("conventional", conventional_m), ("UD", ud_m)],
    )?;
    let both = ["conventional, us", "UD, us", "UD / conventional"];
    let counts = ["conventional, instructions", "UD, instructions", "UD / conventional"];
    let nalgebra = ["nalgebra, nine rows by hand, us"];
    let head = [&["states"][..], &both, &nalgebra, &counts].concat();
    let head_m = [&["measurements"][..], &both, &counts].concat();
    Ok(vec![("states", table(&head, &states)), ("measurements", table(&head_m, &measurements))])
}

/// Instructions with their bounds.
pub(crate) fn instructions(place: &Place) -> Result<Vec<Section>, Error> {
    require("valgrind")?;
    let text = output(place.command("bash").arg("benches/instructions.sh"))?;
    let rows: Vec<Vec<String>> = text
        .lines()
        .filter_map(|line| {
            let [each, bound] = numbers(line)[..] else { return None };
            let name = match line.split(' ').next()? {
                "conventional" => "cycle, conventional",
                "ud" => "cycle, UD",
                "navigation" => "navigation with 43d-b, a sample",
                other => other,
            };
            Some(vec![name.to_owned(), grouped(each), grouped(bound)])
        })
        .collect();
    Ok(vec![("instructions", table(&["", "instructions", "bound"], &rows))])
}

/// Frames on the stack.
pub(crate) fn stack(place: &Place) -> Result<Vec<Section>, Error> {
    require("objdump")?;
    let text = output(place.command("bash").arg("benches/stack.sh"))?;
    let row = |line: &str| {
        let (name, _) = line.split_once(|c: char| c.is_ascii_digit())?;
        let [kernel, caller, both] = numbers(&line[name.len()..])[..] else { return None };
        let frames = [kernel, caller, both].map(grouped);
        line.contains(" + ").then(|| [vec![as_code(name.trim())], frames.to_vec()].concat())
    };
    let rows: Vec<Vec<String>> = text.lines().filter_map(row).collect();
    Ok(vec![("stack", table(&["", "kernel, bytes", "its caller", "together"], &rows))])
}

/// Whole jobs on a log in memory.
pub(crate) fn whole(place: &Place) -> Result<Vec<Section>, Error> {
    let text = place.cargo("bench --quiet --bench whole -- --least")?;
    let samples = text.lines().find_map(|line| line.strip_suffix(" samples")?.parse::<f64>().ok());
    let samples = samples.ok_or("the log's length is missing")?;
    let times = Times::read(&text);
    let pass = times.of("a pass with 36d-p")?;
    let row = |(name, time): (&str, f64)| {
        let each = format!("{:.2}", time / samples);
        vec![name.to_owned(), format!("{:.1}", time / 1e3), each, format!("{:.2}", time / pass)]
    };
    let rows: Vec<Vec<String>> = times.iter().map(row).collect();
    let head = ["", "ms", "us a sample", "passes with 36d-p"];
    Ok(vec![("whole", format!("{} samples:\n\n{}", grouped(samples), table(&head, &rows)))])
}

/// A campaign on one thread and on two.
pub(crate) fn campaign(place: &Place) -> Result<Vec<Section>, Error> {
    let text = place.cargo("bench --quiet --bench campaign -- --least")?;
    let [units, one, two, ratio] = numbers(&text)[..] else {
        return Err(format!("not understood: {text}").into());
    };
    let row = |threads: &str, time: f64, ratio: f64| {
        vec![threads.to_owned(), format!("{:.0}", time * 1e3), format!("{ratio:.2}")]
    };
    let head = ["threads", &format!("{units} units, ms"), "times as fast"];
    Ok(vec![("campaign", table(&head, &[row("1", one, 1.0), row("2", two, ratio)]))])
}

/// A log from file to result: time and memory at three rates.
pub(crate) fn log(place: &Place) -> Result<Vec<Section>, Error> {
    require("time")?;
    place.cargo("build --quiet --release --package sinscal-cli")?;
    let program = place.target("release/sinscal");
    let folder = place.target("logs");
    let memory = folder.join("memory");
    let mut rows = Vec::new();
    for rate in ["25", "200", "400"] {
        let log = folder.join(rate);
        let simulate = ["simulate", "--quiet", "--seed", "1", "--rate", rate, "--out"];
        let begin = Instant::now();
        output(place.command(&program).args(simulate).arg(&log))?;
        let simulated = begin.elapsed().as_secs_f64();
        let size = log.with_extension("parquet").metadata()?.len() as f64;
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for _ in 0..6 {
            let begin = Instant::now();
            let mut calibrate = place.command("time");
            calibrate.args(["--format", "%M", "--output"]).arg(&memory).arg(&program);
            output(calibrate.args(["calibrate", "--quiet", "--filter", "43d-b"]).arg(&log))?;
            let time = begin.elapsed().as_secs_f64();
            (least, most) = (least.min(time), most.max(time));
        }
        let kilobytes = numbers(&std::fs::read_to_string(&memory)?).pop().ok_or("no size of memory")?;
        rows.push(vec![
            rate.to_owned(),
            format!("{:.1}", size / 1e6),
            format!("{simulated:.2}"),
            format!("{least:.2} to {most:.2}"),
            format!("{:.1}", kilobytes / 1e3),
        ]);
    }
    std::fs::remove_dir_all(folder)?;
    let head = ["Hz", "file, MB", "simulate, s", "calibrate, s", "memory of calibrate, MB"];
    Ok(vec![("log", table(&head, &rows))])
}

/// Two days in `f32`.
pub(crate) fn single(place: &Place) -> Result<Vec<Section>, Error> {
    let text = place.cargo("test --quiet --release --test single_precision -- --ignored --nocapture")?;
    let after = |name: &str| text.split_once(name).and_then(|(_, rest)| numbers(rest).first().copied());
    let (Some(ud), Some(conventional), Some(lost)) =
        (after(" ud: "), after("conventional: "), after("Some("))
    else {
        return Err(format!("not understood: {text}").into());
    };
    let row = |name: &str, error: String, definite: String| vec![name.to_owned(), error, definite];
    let rows = [
        row("`f64`, conventional", format!("{conventional:.1e}"), "positive definite throughout".to_owned()),
        row("`f32`, UD", format!("{ud:.1e}"), "positive definite throughout".to_owned()),
        row("`f32`, conventional", String::new(), format!("indefinite after {lost:.0} s")),
    ];
    Ok(vec![("single", table(&["", "largest error of a variance, against the UD form in `f64`", ""], &rows))])
}

/// A crate of one's own with 43 states.
pub(crate) fn compile(place: &Place) -> Result<Vec<Section>, Error> {
    let text =
        place.cargo("test --quiet --release --test fresh_crate -- --ignored --nocapture compile_time")?;
    let row = |profile: &str| {
        let line = text.lines().find_map(|line| line.trim().strip_prefix(&format!("{profile}: ")));
        Ok(vec![format!("`{profile}`"), line.ok_or("a profile is missing")?.replace(" s", "")])
    };
    let rows = ["dev", "release"].map(row).into_iter().collect::<Result<Vec<_>, Error>>()?;
    Ok(vec![("compile", table(&["profile", "s"], &rows))])
}

/// The program on nothing that is built.
pub(crate) fn build(place: &Place) -> Result<Vec<Section>, Error> {
    let folder = place.target("clean");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    let begin = Instant::now();
    place.cargo_in("clean", false, "build --quiet --release")?;
    let time = begin.elapsed().as_secs();
    let size = folder.join("release/sinscal").metadata()?.len() as f64;
    std::fs::remove_dir_all(folder)?;
    let rows = [vec![format!("{} min {} s", time / 60, time % 60), format!("{:.1}", size / 1e6)]];
    Ok(vec![("build", table(&["time", "program, MB"], &rows))])
}
