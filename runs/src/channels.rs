//! What the rows of a filter are of.

use calib_core::{Dynamics, MeasurementInfo};
use sinscal::Strapdown;

/// The rows of a filter's measurements by what they are of: a channel of the dynamics, or behind these a row that is a function of
/// channels.
#[derive(Clone, Debug, Default)]
pub struct Channels {
    /// Channel and row, in the order of the channels.
    pub rows: Vec<(usize, usize)>,
    /// Names by channel, for instance `vel_n`; empty where nothing is measured.
    pub names: Vec<String>,
}

impl Channels {
    /// Those of a list of measurements.
    pub fn of(measures: &[MeasurementInfo]) -> Self {
        let count: usize = measures.iter().map(|info| info.components.len()).sum();
        let mut channels = Self { rows: Vec::new(), names: vec![String::new(); Strapdown::CHANNELS + count] };
        let mut row = 0;
        for info in measures {
            for (i, component) in info.components.iter().enumerate() {
                let channel = info.channels.map_or(Strapdown::CHANNELS + row, |first| first + i);
                channels.rows.push((channel, row));
                channels.names[channel] = format!("{}_{component}", short(info.name));
                row += 1;
            }
        }
        channels.rows.sort_unstable();
        channels
    }
}

/// Measurements as reports name their channels.
fn short(name: &str) -> &str {
    match name {
        "velocity" => "vel",
        "position" => "pos",
        "attitude" => "att",
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use calib_core::Filter;
    use sinscal::measurements::OURS;
    use sinscal::{Sins36P, Tracked35};

    use super::Channels;

    #[test]
    fn rows_are_sorted_by_channel_and_functions_come_last() {
        assert_eq!(Channels::of(Sins36P::MEASURES).rows, (0..6).map(|i| (i, i)).collect::<Vec<_>>());
        let tracked = Channels::of(Tracked35::MEASURES);
        assert_eq!(tracked.rows[0], (3, 0));
        assert_eq!((tracked.names[4].as_str(), tracked.names[8].as_str()), ("pos_n", "att_u"));
        assert_eq!(tracked.names[0], "");
        let all = Channels::of(&OURS);
        // the height is the position's third channel once more, the heading a function
        assert_eq!(all.rows[5..7], [(5, 5), (5, 12)]);
        assert_eq!(all.rows.last(), Some(&(12 + 13, 13)));
        assert_eq!(all.names[12 + 13], "heading_psi");
    }
}
