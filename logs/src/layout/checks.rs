//! What must be there, and together.

use crate::columns::{Group, NAMES};
use crate::fault::LogError;

use super::{Part, Search};

impl Search<'_> {
    /// What must be there, and together.
    pub(super) fn check(&mut self) {
        let path = self.path;
        let pairs = [(Group::DTHETA, Group::GYRO_PULSE), (Group::DVEL, Group::ACCEL_PULSE)];
        for (increments, pulses) in pairs.into_iter().filter(|_| self.asked.part != Part::Reference) {
            let (first, alternative) = (increments.names()[0], pulses.names()[0]);
            match (self.any(increments), self.any(pulses)) {
                (true, true) => {
                    let problem =
                        format!("stands beside `{alternative}`: increments or pulse counts, not both");
                    self.faults.push(LogError::column(path, first, problem));
                }
                (false, false) => {
                    let missing = increments.names().join(", ");
                    let help = format!(
                        "expected {missing} (or {} with the scales in [imu])",
                        pulses.names().join(", ")
                    );
                    self.faults.push(LogError::column(path, first, "is missing").help(help));
                }
                _ => {}
            }
        }
        if self.asked.part == Part::Reference
            && !Group::ALL.into_iter().any(|group| group.is_of_reference() && self.any(group))
        {
            let help = "its columns go by the names of the format (ref_pos_e ...), or --map ref_pos=NAME, ref_lat=, ref_quat= names them";
            self.faults.push(LogError::file(path, "holds no reference").help(help));
        }
        if self.any(Group::REF_LATLON) && !self.any(Group::REF_HEIGHT) {
            let help = "a position is latitude, longitude and height: --map ref_height=NAME";
            self.faults
                .push(LogError::column(path, "ref_height_m", "is missing beside `ref_lat_deg`").help(help));
        }
        if self.any(Group::REF_EULER) {
            if !self.asked.axes.has_euler_order() {
                let help = "say in which order the angles turn: --axes euler=zyx is yaw, pitch, roll";
                self.faults.push(LogError::column(path, "ref_roll_deg", "has no order").help(help));
            }
            if self.any(Group::REF_QUAT) {
                let problem = "stands beside `ref_quat_w`: angles or a quaternion, not both";
                self.faults.push(LogError::column(path, "ref_roll_deg", problem));
            }
        }
        if (self.any(Group::REF_EULER) || self.any(Group::REF_QUAT))
            && self.asked.axes.attitude_is_impossible()
        {
            let help = "let `imu` be the axes that the attitude is about, and give `gyro` and `accel` apart";
            let problem = "is an attitude, and the axes it would be about are left-handed";
            self.faults.push(LogError::column(path, "ref_quat_w", problem).help(help));
        }
        for (position, other) in [(Group::REF_POS, Group::REF_LATLON)] {
            if self.any(position) && self.any(other) {
                let problem = "stands beside `ref_lat_deg`: metres or latitude and longitude, not both";
                self.faults.push(LogError::column(path, "ref_pos_e", problem));
            }
        }
        for group in Group::ALL {
            if !self.any(group) || self.has(group) {
                continue;
            }
            let (there, missing): (Vec<usize>, Vec<usize>) =
                group.slots().partition(|slot| self.places[*slot].is_some());
            let names =
                |slots: &[usize]| slots.iter().map(|slot| NAMES[*slot]).collect::<Vec<_>>().join("`, `");
            let problem = format!("is missing beside `{}`", names(&there));
            let help = format!("{} come together or not at all", group.names().join(", "));
            self.faults.push(LogError::column(path, &names(&missing), problem).help(help));
        }
    }
}
