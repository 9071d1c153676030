//! The results for people.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::time::Duration;

use logs::units::{DEGREE, MICRO_G};
use logs::{Bridged, Log};
use runs::{AnyFilter, Look, Outcome, Verdict};
use sinscal::{CoarseCalibration, Parameter, Site, SiteFault, Smoothed, earth};

use reports::figures::{decimals, significant};

/// So many stretches of refused readings are listed.
const DESCRIBED: usize = 20;
/// Shares of the reference left out that deserve a word: in a single pass, and where a pass before has shown what is usual.
const MANY_LEFT_OUT: [f64; 2] = [0.02, 0.1];

/// What to say where much of the reference was left out, and what to do about it.
pub(super) fn doubt(outcome: &Outcome, passes: u32) -> Option<String> {
    let share = outcome.left_out();
    if outcome.verdict() == Verdict::Elsewhere {
        return Some(elsewhere(outcome));
    }
    if !(share > MANY_LEFT_OUT[usize::from(passes > 1)]) {
        return None;
    }
    let rejected = outcome.statistics.rejected;
    let outliers = || outcome.refused.iter().filter(|stretch| stretch.why == "outlier");
    let first = outliers().map(|stretch| stretch.first_s).fold(f64::INFINITY, f64::min);
    let last = outliers().map(|stretch| stretch.last_s).fold(f64::NEG_INFINITY, f64::max);
    let advice = if passes == 1 {
        format!(
            "a single pass cannot tell what {} lacks from outliers: run two (--passes 2), or a filter that lacks nothing \
             (sinscal diagnose)",
            outcome.filter
        )
    } else {
        "check unit, sign and frame of the reference, its sigmas in [reference], and the attitude in [initial]".into()
    };
    let percent = 100.0 * share;
    Some(format!(
        "{rejected} readings of the reference ({percent:.0} %) were left out as far off, from {first:.0} s to {last:.0} s; {advice}"
    ))
}

/// What to say where a unit is moved that is taken to stand still.
fn elsewhere(outcome: &Outcome) -> String {
    let times = outcome.refused.iter().map(|stretch| (stretch.first_s, stretch.last_s));
    let (first, last) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), (from, to)| {
        (first.min(from), last.max(to))
    });
    let spike = outcome.look.spike().map_or(String::new(), |(sensor, time, by)| {
        let unit = if sensor.starts_with("gyro") { "rad/s" } else { "m/s^2" };
        format!("; at {time:.3} s the {sensor} reads {by:.3} {unit} off both its neighbours")
    });
    format!(
        "from {first:.1} s to {last:.1} s the increments move the unit where it is taken to stand still: nobody measured that, so \
         the site, the increments or what {} lacks are at fault{spike}",
        outcome.filter
    )
}

/// What rests in several positions say of the site, against what is stated.
fn site_shown(text: &mut String, outcome: &Outcome, site: &Site) {
    let Some(shown) = &outcome.site else { return };
    let of = |(value, sigma): (f64, f64), scale: f64, stated: f64| {
        let digits = decimals(sigma / scale);
        format!(
            "{:.digits$} +- {:.digits$} (stated {:.digits$})",
            value / scale,
            sigma / scale,
            stated / scale
        )
    };
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "rests in {} positions show a latitude of {} deg, an Earth's rate of {} deg/h, gravity of {} m/s^2\n",
        shown.positions,
        of(shown.latitude, DEGREE, site.latitude),
        of(shown.earth_rate, DEGREE / 3600.0, earth::ROTATION_RATE),
        of(shown.gravity, 1.0, earth::gravity(site.latitude, site.height))
    );
}

/// What to look at where they contradict each other.
pub(super) fn site_fault(outcome: &Outcome) -> Option<&'static str> {
    Some(match outcome.site_fault? {
        SiteFault::Latitude => {
            "the rests show another latitude than [site] states: look at latitude_deg, and whether the gyros feel the specific force"
        }
        SiteFault::Gravity => {
            "the rests show another gravity than that of the site: look at height_m, and at the units and scale of the accelerometers"
        }
        _ => {
            "the rests show another rate of the Earth: look at the clock (imu.rate_hz, stamps), and at the units and scale of the gyros"
        }
    })
}

/// What the samples themselves say, and a reader of the results should know; `failed` says that they do not go together with the
/// filter. A sensor that reads nothing but 0 may be an ideal one at rest, as long as it contradicts nothing.
pub(crate) fn oddities(look: &Look, failed: bool) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    said.extend(look.saturated().map(|saturated| format!("the {saturated}: what is found of it is wrong")));
    let dead: Vec<&str> = look.dead().collect();
    if failed && !dead.is_empty() {
        said.push(format!("{} read nothing but 0", dead.join(", ")));
    }
    said.extend(look.fahrenheit().map(|(read, told)| {
        format!(
            "the temperatures begin at {read:.1} degC: {read:.1} degF would be {told:.1} degC; if they are in degF, read them with \
             --map temp=NAME:degF"
        )
    }));
    let rounded: Vec<String> =
        look.rounded().map(|(sensor, part)| format!("{sensor} ({:.0} %)", 100.0 * part)).collect();
    if !rounded.is_empty() {
        said.push(format!(
            "the readings are rounded to about the size of their noise, and repeat to the last digit from row to row: {}; write the \
             log with more digits, or the sigmas are too small",
            rounded.join(", ")
        ));
    }
    said
}

/// A reference whose stamps are off by so much, s.
pub(super) fn late(by: f64) -> String {
    format!(
        "the reference shows what the inertial sensors show {:.0} ms {}: its stamps are suspect; `sinscal diagnose` takes such a delay out and \
         tells it to a millisecond or so",
        1e3 * by.abs(),
        if by > 0.0 { "earlier" } else { "later" }
    )
}

/// Whether the filter explains the data, in one line.
pub(super) fn verdict(outcome: &Outcome) -> String {
    let statistics = &outcome.statistics;
    let mut text = format!(
        "{} {}: NIS per degree of freedom {:.2} over {} updates",
        outcome.filter,
        outcome.verdict(),
        statistics.nis_per_dof(),
        statistics.updates
    );
    if statistics.rejected > 0 {
        let what = if outcome.look.is_fixed_point() {
            "comparisons with a unit that stands still"
        } else {
            "outliers of the reference"
        };
        let _ = write!(text, ", {} {what} left out", statistics.rejected);
    }
    if statistics.repeated > 0 {
        let _ = write!(text, ", {} readings that only repeat the one before", statistics.repeated);
    }
    if let Some(moved) = outcome.moved {
        // further digits say nothing
        let _ = match outcome.verdict() {
            Verdict::PassesDisagree => {
                write!(text, "; it would move something by {} sigma", significant(moved))
            }
            _ if moved > 1.0 => {
                write!(text, "; passes agree only to {} sigma, which the sigmas contain", significant(moved))
            }
            _ => write!(text, "; passes agree to {} sigma", significant(moved.max(0.01))),
        };
    }
    text
}

/// Verdict, parameters and final state. Writing to a string does not fail.
pub(super) fn table(
    log: &Log,
    filter: &dyn AnyFilter,
    outcome: &Outcome,
    bridged: Bridged,
    wall: Duration,
) -> String {
    let considered = filter.considers();
    let mut text = verdict(outcome) + "\n";
    let _ = writeln!(
        text,
        "{} samples, {:.1} s, computed in {:.2} s\n",
        outcome.samples - bridged.rows,
        outcome.duration,
        wall.as_secs_f64()
    );
    if let Some(coarse) = log.coarse() {
        coarse_stage(&mut text, coarse);
    }
    site_shown(&mut text, outcome, &log.description().site);
    let _ = writeln!(
        text,
        "{:30} {:>14}   {:10} {:10} {:>11}  {:>10}  {:>6}",
        "parameter", "estimate", "+- sigma", "unit", "prior sigma", "converged", "halves"
    );
    for (index, parameter) in outcome.parameters.iter().enumerate() {
        let info = &parameter.info;
        let name = format!("{} {}", info.block, info.component);
        let [mut estimate, sigma] = figures(parameter);
        if considered.contains(&info.block) {
            estimate = "considered".into();
        }
        let converged = match outcome.converged(index) {
            Some(time) if parameter.estimated => format!("{time:.0} s"),
            _ => "-".into(),
        };
        let halves = outcome.repeat.as_ref().and_then(|repeat| repeat.halves[index]);
        let halves =
            halves.filter(|_| parameter.estimated).map_or("-".into(), |halves| format!("{halves:.1}"));
        let prior = significant(parameter.prior_sigma / info.sheet_scale);
        let _ = writeln!(
            text,
            "{name:30} {estimate:>14}   {sigma:10} {:10} {prior:>11}  {converged:>10}  {halves:>6}",
            info.sheet_unit
        );
    }
    ranges(&mut text, filter, outcome);
    repeatability(&mut text, outcome);
    refusals(&mut text, outcome);
    let attitude = outcome.attitude.quaternion();
    let (position, velocity) = (&outcome.position, &outcome.velocity);
    let _ = writeln!(
        text,
        "\nat the end: attitude (w, x, y, z) {:.6} {:.6} {:.6} {:.6}",
        attitude.w, attitude.i, attitude.j, attitude.k
    );
    let _ = writeln!(
        text,
        "            position of the IMU (east, north, up) {:.4} {:.4} {:.4} m, velocity {:.5} {:.5} {:.5} m/s",
        position.x, position.y, position.z, velocity.x, velocity.y, velocity.z
    );
    text
}

/// Between which values went what changes in the course of the run.
fn ranges(text: &mut String, filter: &dyn AnyFilter, outcome: &Outcome) {
    let mut head = "\nin the course of the run, since it converged:\n";
    for (index, parameter) in outcome.parameters.iter().enumerate() {
        let Some((least, most)) = outcome.range(index, |name| filter.changes(name)) else { continue };
        let info = &parameter.info;
        let digits = decimals(parameter.sigma / info.sheet_scale);
        let of = |value: f64| format!("{:.digits$}", value / info.sheet_scale);
        let name = format!("{} {}", info.block, info.component);
        let _ = writeln!(text, "{head}{name:30} from {} to {} {}", of(least), of(most), info.sheet_unit);
        head = "";
    }
}

/// What the sigmas are, and how the halves of the log compare.
fn repeatability(text: &mut String, outcome: &Outcome) {
    let Some(repeat) = &outcome.repeat else { return };
    let halves: Vec<f64> = repeat.halves.iter().flatten().copied().collect();
    if !halves.is_empty() {
        let rms = (halves.iter().map(|half| half * half).sum::<f64>() / halves.len() as f64).sqrt();
        let _ = writeln!(
            text,
            "\nhalves: how many sigmas lie between the estimates of the two halves of the log; {rms:.2} rms"
        );
    }
    let most = repeat.scatter.iter().filter(|scatter| scatter.is_more());
    // where something is considered the budget says it
    if outcome.budget.is_empty()
        && let Some(most) = most.max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    {
        let largest = repeat.factors.iter().fold(1.0_f64, |largest, factor| largest.max(*factor));
        let _ = writeln!(
            text,
            "sigmas are larger than the filter's own, by up to {largest:.1}: {} stretches of the log differ {:.1} times as much as its noise allows \
             (chance: {:.1})",
            most.stretches,
            most.ratio.sqrt(),
            most.limit.sqrt()
        );
    }
}

/// What the coarse stage found.
fn coarse_stage(text: &mut String, coarse: &CoarseCalibration) {
    let _ = writeln!(
        text,
        "coarse stage: {} still positions and {} turns, {} ug of gravity left from position to position",
        coarse.positions,
        coarse.turns,
        significant(coarse.force_residual / MICRO_G)
    );
    for (name, size) in
        [("gyro_rad_per_pulse", coarse.gyro_pulse), ("accel_m_s_per_pulse", coarse.accel_pulse)]
    {
        if let Some(size) = size {
            let _ = writeln!(text, "in [imu]: {name} = [{:e}, {:e}, {:e}]", size.x, size.y, size.z);
        }
    }
    text.push('\n');
}

/// When readings of the reference were left out.
fn refusals(text: &mut String, outcome: &Outcome) {
    if outcome.refused.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nleft out of the reference:");
    for stretch in outcome.refused.iter().take(DESCRIBED) {
        let what = if stretch.why == "repeated" { "that repeat the one before" } else { "far off" };
        let _ = writeln!(
            text,
            "{:30} {:>6} readings {what}, from {:.2} s to {:.2} s",
            stretch.channel, stretch.readings, stretch.first_s, stretch.last_s
        );
    }
    if outcome.refused.len() > DESCRIBED {
        let _ = writeln!(text, "and {} more stretches: --json lists all", outcome.refused.len() - DESCRIBED);
    }
    if outcome.statistics.reopened > 0 {
        let _ = writeln!(
            text,
            "{} times a reference that stayed far off was taken to begin anew",
            outcome.statistics.reopened
        );
    }
}

/// Estimate and sigma in data-sheet units, to two figures of the sigma.
pub(super) fn figures(parameter: &Parameter) -> [String; 2] {
    if !parameter.estimated {
        return ["not estimated".into(), String::new()];
    }
    let scale = parameter.info.sheet_scale;
    let (value, sigma) = (parameter.value / scale, parameter.sigma / scale);
    let digits = decimals(sigma);
    [format!("{value:.digits$}"), format!("{sigma:.digits$}")]
}

/// Estimates and sigmas over time, as comma-separated text in SI units.
pub(super) fn history(outcome: &Outcome, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "time_s")?;
    for parameter in &outcome.parameters {
        let info = &parameter.info;
        let name = if info.component.is_empty() {
            info.block.to_owned()
        } else {
            format!("{}.{}", info.block, info.component)
        };
        write!(out, ",{name},{name}.sigma")?;
    }
    writeln!(out)?;
    for (time, points) in outcome.history.rows() {
        write!(out, "{time}")?;
        for (value, sigma) in points {
            write!(out, ",{value:e},{sigma:e}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The smoothed navigation solution as CSV, one line for each update.
pub(super) fn trajectory(smoothed: &[Smoothed], site: &Site, file: &mut dyn Write) -> io::Result<()> {
    write!(file, "time_s,quat_w,quat_x,quat_y,quat_z,vel_e,vel_n,vel_u,pos_e,pos_n,pos_u")?;
    for quantity in ["att", "vel", "pos"] {
        for axis in ["e", "n", "u"] {
            write!(file, ",{quantity}_{axis}.sigma")?;
        }
    }
    writeln!(file)?;
    for point in smoothed {
        let Smoothed { time, navigation, .. } = point;
        let (q, v, p) = (navigation.attitude, navigation.velocity, navigation.position(site));
        let numbers = [q.w, q.i, q.j, q.k, v.x, v.y, v.z, p.x, p.y, p.z];
        write!(file, "{time}")?;
        for number in numbers.into_iter().chain(point.sigmas()) {
            write!(file, ",{number:e}")?;
        }
        writeln!(file)?;
    }
    Ok(())
}
