//! Arguments that several subcommands have in common.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use miette::Result;
use rig::Scenario;
use runs::AnyFilter;

use crate::compose::Change;
use crate::output::Target;
use crate::vocabulary::vocabulary;
use crate::{say, scenario};
use logs::{ColumnMap, Log};

/// What is worked on.
#[derive(Args)]
pub(crate) struct LogArgument {
    /// The log: path of its table or description, with or without ending
    pub(crate) log: PathBuf,
    #[command(flatten)]
    pub(crate) columns: Columns,
}

/// Which variables of a file are the columns of the log format
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Columns {
    /// Names and units of the columns in a file that others wrote, such as gyro=wm,accel=acc:m/s^2,time=t
    ///
    /// Left stands a column of the log format (dtheta_x) or all of a kind: time, gyro, accel, gyro_pulse, accel_pulse, temp,
    /// temp_gyro, dither, ref_vel, ref_pos, ref_quat. Right stands the file's variable, and after it, where needed, its columns,
    /// counted from 0, and its unit; a minus before it turns the sign. What holds rates (deg/s, rad/s, g, m/s^2) becomes
    /// increments by the time between rows. The same map serves every log of the command. Not needed for the names of the format,
    /// nor for the seven columns [wm vm t] of PSINS in a MATLAB, NumPy or HDF5 file.
    ///
    ///   --map gyro=wm,accel=vm,time=t           three arrays
    ///   --map gyro=imu[0:3],accel=imu[3:6]:g    columns of one array, forces in g
    ///   --map gyro=w:deg/s,time=t:ms            columns w_x, w_y, w_z (or wx, w.x ...) of a table
    ///   --map ref_quat=q[3,0,1,2]               the scalar comes last in the file
    ///   --map dtheta_x=w[1],dtheta_y=w[0],dtheta_z=-w[2]    from forward-right-down
    #[arg(long = "map", value_name = "NAME=VARIABLE,...", verbatim_doc_comment)]
    maps: Vec<ColumnMap>,
}

impl Columns {
    /// All that was given.
    pub(crate) fn map(&self) -> ColumnMap {
        self.maps.iter().cloned().collect()
    }
}

impl LogArgument {
    /// Opens it.
    pub(crate) fn open(&self) -> Result<Log> {
        open(&self.log, &self.columns.map())
    }
}

/// Opens a log and says what is odd about it.
pub(crate) fn open(path: &Path, columns: &ColumnMap) -> Result<Log> {
    let log = Log::open(path, columns)?;
    tell(&log);
    Ok(log)
}

/// Says what is odd about a log.
pub(crate) fn tell(log: &Log) {
    say::detail(|| format!("reading {}", log.table().display()));
    log.warnings().iter().for_each(|warning| say::warn(warning));
}

/// What it is worked on with.
#[derive(Args)]
pub(crate) struct FilterArgument {
    /// The filter; `sinscal filters` describes them
    #[arg(long, value_name = "NAME", ignore_case = true, value_parser = filter())]
    filter: Arc<dyn AnyFilter>,
    #[command(flatten)]
    change: Change,
}

impl FilterArgument {
    /// The filter with what was added to it.
    pub(crate) fn filter(&self) -> Result<Arc<dyn AnyFilter>> {
        self.change.of(&self.filter)
    }
}

/// Finds a filter by its name, without regard to case.
pub(crate) fn filter() -> impl TypedValueParser<Value = Arc<dyn AnyFilter>> {
    let names = vocabulary().filters().map(|filter| filter.name());
    PossibleValuesParser::new(names).try_map(|name| vocabulary().filter(&name))
}

/// Where results go.
#[derive(Args)]
pub(crate) struct Results {
    /// Write the results as JSON; `-` writes them to standard output instead of the text
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Write report.html, the results as JSON, text and tables, and every figure as SVG and CSV to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

impl Results {
    /// Refuses places that could not be written at the end of a long run.
    pub(crate) fn target(&self) -> Result<Target<'_>> {
        Target::new(self.json.as_deref(), self.out.as_deref())
    }
}

/// Whom a population is drawn from.
#[derive(Args)]
pub(crate) struct Drawn {
    /// The scenario that units are drawn from and calibrated in; without, the default one
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) scenario: Option<PathBuf>,
    /// Number of the first unit
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(0..1 << 60))]
    pub(crate) seed: u64,
}

impl Drawn {
    /// The scenario.
    pub(crate) fn load(&self) -> Result<Scenario> {
        scenario::load(self.scenario.as_deref())
    }
}

/// Hours of navigation.
pub(crate) fn hours(text: &str) -> Result<f64, String> {
    within(text, "hours", 0.01, 1000.0)
}

/// Length of the alignment that a log begins with, s, where nothing else is asked for.
pub(crate) const ALIGNMENT: f64 = 900.0;

/// Seconds of an alignment.
pub(crate) fn alignment(text: &str) -> Result<f64, String> {
    within(text, "seconds", 10.0, 86_400.0)
}

/// A number from `least` to `most`.
pub(crate) fn within(text: &str, unit: &str, least: f64, most: f64) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("a number of {unit} from {least} to {most} was expected")),
    }
}
