//! Columns of files whose layout is known, and times that nothing names.

use crate::columns::Group;
use crate::fault::LogError;
use crate::map::Unit;
use crate::names::Name;
use crate::written;

use super::{Holds, PSINS, Part, Search, short};

/// How the arrays of an inertial unit are called: rad/s, m/s^2, and times with the size of their unit, the part of a second last.
pub(super) struct NamedLayout {
    of: &'static str,
    pub(super) gyro: &'static str,
    pub(super) accel: &'static str,
    times: &'static [(&'static str, f64)],
    axes: &'static str,
}

const LAYOUTS: [NamedLayout; 3] = [
    NamedLayout {
        of: "NaveGo",
        gyro: "wb",
        accel: "fb",
        times: &[("t", 1.0)],
        axes: "forward, right, down (`--axes imu=frd`)",
    },
    NamedLayout {
        of: "ROS",
        gyro: ".angular_velocity",
        accel: ".linear_acceleration",
        times: &[(".stamp.secs", 1.0), (".stamp.nsecs", 1e-9)],
        axes: "forward, left, up (`--axes imu=flu`)",
    },
    NamedLayout {
        of: "PX4",
        gyro: ".gyro_rad",
        accel: ".accelerometer_m_s2",
        times: &[(".timestamp", 1e-6)],
        axes: "forward, right, down (`--axes imu=frd`)",
    },
];

impl Search<'_> {
    /// The array that is laid out as PSINS does: the one called so, or the only one.
    pub(super) fn psins_variable(&self) -> Option<usize> {
        let named = self.find(PSINS.0);
        let only = (self.variables.len() == 1).then_some(0);
        let seven = |index: &usize| self.variables[*index].width == Ok(PSINS.1);
        named.or(only).filter(seven).filter(|_| self.holds == Holds::Arrays)
    }

    /// The layouts of inertial units that are there, each with the beginning of its names.
    pub(super) fn named_layouts(&self) -> Vec<(String, &'static NamedLayout)> {
        if self.holds != Holds::Arrays {
            return Vec::new();
        }
        let beginnings = |layout: &'static NamedLayout| {
            let beginning = |name: &Name| name.stem().strip_suffix(layout.gyro).map(str::to_owned);
            let all = |beginning: &String| {
                let there = |end: &str| self.find(&format!("{beginning}{end}")).is_some();
                there(layout.accel) && layout.times.iter().all(|(end, _)| there(end))
            };
            let found = self.names.iter().filter_map(beginning).filter(all);
            found.map(|beginning| (beginning, layout)).collect::<Vec<_>>()
        };
        LAYOUTS.iter().flat_map(beginnings).collect()
    }

    /// Fills what is missing from layouts that go by their names, and from that of PSINS.
    pub(super) fn layouts(&mut self) {
        if self.asked.part == Part::Reference {
            return;
        }
        if let [(beginning, layout)] = &self.named_layouts()[..] {
            self.named_layout(beginning, layout);
        }
        let Some(variable) = self.psins_variable() else { return };
        for (first, group, instead) in [
            (0, Group::DTHETA, Some(Group::GYRO_PULSE)),
            (3, Group::DVEL, Some(Group::ACCEL_PULSE)),
            (6, Group::TIME, None),
        ] {
            if self.any(group) || instead.is_some_and(|group| self.any(group)) {
                continue;
            }
            for (column, slot) in (first..).zip(group.slots()) {
                let text = format!("{}[{column}]", self.variables[variable].name);
                self.place(slot, variable, column, Unit::SAME, Some(text));
            }
        }
    }

    fn named_layout(&mut self, beginning: &str, layout: &NamedLayout) {
        let rate = Unit { per_interval: true, ..Unit::SAME };
        let times = Group::TIME.slots().chain(Group::TIME_NANOS.slots()).zip(layout.times);
        let times = times.map(|(first, (end, scale))| {
            (*end, Group { first, len: 1 }, Unit { scale: *scale, ..Unit::SAME })
        });
        let any = [Group::DTHETA, Group::DVEL, Group::TIME].map(|group| self.any(group));
        let mut read = Vec::new();
        let parts = [(layout.gyro, Group::DTHETA, rate), (layout.accel, Group::DVEL, rate)];
        for (end, group, unit) in parts.into_iter().chain(times) {
            let taken = match group {
                Group::DTHETA => any[0],
                Group::DVEL => any[1],
                _ => any[2],
            };
            let name = format!("{beginning}{end}");
            let Some(index) = self.find(&name).filter(|_| !taken) else { continue };
            if self.variables[index].width == Ok(group.len) {
                for (column, slot) in group.slots().enumerate() {
                    self.place(slot, index, column, unit, Some(format!("{name}[{column}]")));
                }
                read.push(format!("`{name}`"));
            }
        }
        if !read.is_empty() {
            self.notes.push(format!(
                "{} are read as {} has them, in SI; its axes are {} unless they were turned",
                read.join(", "),
                layout.of,
                layout.axes
            ));
        }
    }

    /// Finds the time where nothing says which it is.
    pub(super) fn time(&mut self) {
        if self.any(Group::TIME) {
            return;
        }
        let free = |index: &usize| self.variables[*index].width == Ok(1);
        let unused = |index: &usize| !self.places.iter().flatten().any(|place| place.variable == *index);
        // of several the one that belongs to what is read
        let used = self.places.iter().flatten().map(|place| place.variable).next();
        let near = |index: &usize| {
            let pair =
                used.map(|used| (self.variables[*index].name.as_str(), self.variables[used].name.as_str()));
            pair.map_or(0, |(a, b)| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count())
        };
        let times =
            (0..self.names.len()).filter(|index| self.names[*index].is_time()).filter(free).filter(unused);
        // the first of those that are equally near
        let Some(index) = times.rev().max_by_key(near) else {
            if self.asked.part == Part::Reference {
                let help = "--map ref_time=NAME:UNIT names it";
                self.faults.push(LogError::column(self.path, "time_s", "is missing").help(help));
            } else if !self.asked.by_rate {
                self.notes.push(
                    "there is no column of times: the rows are taken to be evenly spaced by imu.rate_hz"
                        .into(),
                );
            }
            return;
        };
        if self.asked.by_rate {
            return;
        }
        let name = self.variables[index].name.clone();
        let stem = self.names[index].stem().to_owned();
        let beginning = name.rsplit_once(['.', '/']).map_or("", |(beginning, _)| beginning).to_owned();
        let fraction = (0..self.names.len()).filter(|of| self.names[*of].is_fraction()).filter(free);
        let mut fraction = fraction.filter(|of| self.variables[*of].name.starts_with(&beginning));
        let fraction = fraction.next();
        if let Some(fraction) =
            fraction.filter(|_| stem.to_ascii_lowercase().ends_with("sec") || stem.ends_with("secs"))
        {
            self.place(Group::TIME.first, index, 0, Unit::SAME, Some(name.clone()));
            let nanos = Unit::of_format(Group::TIME_NANOS.first);
            let other = self.variables[fraction].name.clone();
            self.place(Group::TIME_NANOS.first, fraction, 0, nanos, Some(other.clone()));
            self.notes.push(format!("time is read from `{}` and `{}`", short(&name), short(&other)));
            return;
        }
        let unit = self.names[index].unit.as_ref().map(|unit| written::unit(Group::TIME, unit));
        if let Some(Ok(unit)) = unit {
            self.place(Group::TIME.first, index, 0, unit, Some(name.clone()));
            self.notes.push(format!("time is read from `{}`", short(&name)));
            return;
        }
        let named = if self.asked.part == Part::Reference { "ref_time" } else { "time" };
        let help = format!(
            "--map {named}={}:UNIT with the unit s, ms, us or ns reads `{}`; `--stamps rate` takes the rows as evenly spaced",
            stem,
            short(&name)
        );
        self.faults.push(LogError::column(self.path, "time_s", "is missing").help(help));
    }
}
