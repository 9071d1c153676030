//! Arguments that several subcommands have in common.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use miette::{Result, miette};
use rig::Scenario;
use runs::AnyFilter;

use crate::compose::{Change, considering};
use crate::output::Target;
use crate::setup::Beginning;
use crate::vocabulary::vocabulary;
use crate::{say, scenario};
use logs::{Axes, ColumnMap, Log, Reading, Stamps};

/// What is worked on.
#[derive(Args)]
pub(crate) struct LogArgument {
    /// The log: path of its table or description, with or without ending
    pub(crate) log: PathBuf,
    #[command(flatten)]
    pub(crate) columns: Columns,
}

/// How a log is read
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Columns {
    /// Names and units of the columns in a file that others wrote, such as gyro=wm,accel=acc:m/s^2,time=t
    ///
    /// Left stands a column of the log format (dtheta_x) or all of a kind: time, gyro, accel, gyro_pulse, accel_pulse, temp,
    /// temp_gyro, dither, ref_vel, ref_pos, ref_quat, ref_lat, ref_lon, ref_height, ref_heading, ref_euler (or ref_roll, ref_pitch,
    /// ref_yaw), ref_vel_sigma, ref_pos_sigma, ref_att_sigma, ref_fix; ref_time where the reference is a file of its own. Right
    /// stands the file's variable, and after it, where needed, its columns, counted from 0, and its unit; a minus before it turns
    /// the sign. A unit behind the name in the file, as in wx [deg/s], need not be repeated. What holds rates (deg/s, rad/s, g,
    /// m/s^2) becomes increments by the time between rows. The same map serves every log of the command. Not needed for the names
    /// of the format, nor for the seven columns [wm vm t] of PSINS in a MATLAB, NumPy or HDF5 file, nor NaveGo's imu.wb, imu.fb.
    ///
    ///   --map gyro=wm,accel=vm,time=t           three arrays
    ///   --map gyro=imu[0:3],accel=imu[3:6]:g    columns of one array, forces in g
    ///   --map gyro=w:deg/s,time=t:ms            columns w_x, w_y, w_z (or wx, w.x, w[0] ...) of a table
    ///   --map 'gyro=Gyro {X,Y,Z} raw:deg/s'     three names with a common pattern
    ///   --map 'accel=a:16384 LSB/g,gyro=g-32768:131 LSB/(deg/s)'   counts, and counts about 32768
    ///   --map time=secs+nsecs                   a time in two columns
    ///   --map temp=T,temp_gyro=T:K              one thermometer for three sensors, or for six, in kelvin
    ///   --map ref_quat=q[3,0,1,2]               the scalar comes last in the file
    ///   --map dtheta_x=w[1],dtheta_y=w[0],dtheta_z=-w[2]    from forward-right-down; --axes does it too
    #[arg(long = "map", value_name = "NAME=VARIABLE,...", verbatim_doc_comment)]
    maps: Vec<ColumnMap>,
    /// Which way the file's axes point, such as imu=frd,reference=ned
    ///
    /// Ours are right, forward, up (rfu) and east, north, up (enu). Three letters name the directions of the file's x, y and z:
    /// r l f b u d for the unit, e w n s u d for the reference. Or in our axes: +y-x+z (which is flu) has the file's x along our y
    /// and its y against our x; all 48 may be said, left-handed ones too. The attitude of the reference is turned along.
    ///
    ///   imu=frd              the unit; gyro=... and accel=... go before it for their own triad
    ///   reference=ned        ref_vel, ref_pos, ref_quat, ref_euler
    ///   quaternion=xyzw      the scalar comes last; 'quaternion=wxyz reference-to-body' is the inverse
    ///   euler=zyx            the order in which ref_yaw, ref_pitch, ref_roll turn
    #[arg(long, value_name = "NAME=DIRECTIONS,...", verbatim_doc_comment)]
    axes: Option<Axes>,
    /// What the stamps are worth: `trust` takes every step as long as it is, `rate` takes rows as evenly spaced by imu.rate_hz, `fit`
    /// puts a straight line through jittered stamps
    #[arg(long, value_name = "trust|rate|fit")]
    stamps: Option<Stamps>,
    /// Names of the columns of a text that has none, with commas between
    #[arg(long = "columns", value_name = "NAMES", value_parser = names())]
    names: Option<Names>,
    /// Noise of the sensors: a file with a table [noise], such as `sinscal noise --out DIR` writes to DIR/noise.toml; it goes before
    /// that of the description
    #[arg(long, value_name = "FILE")]
    noise: Option<PathBuf>,
    /// Fill gaps of up to so many seconds with interpolated rows
    #[arg(long, value_name = "SECONDS", value_parser = gap)]
    bridge_gaps: Option<f64>,
}

/// Names of columns.
#[derive(Clone, Debug)]
struct Names(Vec<String>);

fn names() -> impl TypedValueParser<Value = Names> {
    clap::builder::StringValueParser::new().try_map(|text| logs::column_names(&text).map(Names))
}

fn gap(text: &str) -> Result<f64, String> {
    within(text, "seconds", 0.0, 10.0)
}

impl Columns {
    /// All that was given.
    pub(crate) fn reading(&self) -> Reading {
        Reading {
            map: self.maps.iter().cloned().collect(),
            axes: self.axes.clone().unwrap_or_default(),
            stamps: self.stamps,
            columns: self.names.as_ref().map(|names| names.0.clone()),
            bridge: self.bridge_gaps,
            noise: self.noise.clone(),
            own: Vec::new(),
            effects: vocabulary().own_effects().into_iter().map(|effect| effect.info()).collect(),
            values: None,
        }
    }
}

impl Columns {
    /// The same for what a filter measures.
    pub(crate) fn reading_for(&self, filter: &dyn AnyFilter) -> Reading {
        Reading { own: filter.own_columns().into_iter().map(Into::into).collect(), ..self.reading() }
    }
}

impl LogArgument {
    /// Opens it for a filter.
    pub(crate) fn open_for(&self, filter: &dyn AnyFilter, beginning: Beginning) -> Result<Log> {
        open_for(&self.log, &self.columns, filter, beginning)
    }
}

/// Opens a log and says what is odd about it.
pub(crate) fn open(path: &Path, reading: &Reading) -> Result<Log> {
    let log = Log::open(path, reading)?;
    tell(&log);
    Ok(log)
}

/// Opens a log for a filter, and says what is odd about it and what is assumed.
pub(crate) fn open_for(
    path: &Path,
    columns: &Columns,
    filter: &dyn AnyFilter,
    beginning: Beginning,
) -> Result<Log> {
    let mut log = Log::open_counting(path, &columns.reading_for(filter))?;
    beginning.prepare(&mut log, filter)?;
    Ok(log)
}

/// Says what is odd about a log.
pub(crate) fn tell(log: &Log) {
    say::detail(|| format!("reading {}", log.table().display()));
    log.warnings().iter().for_each(|warning| say::warn(warning));
    log.assumed().iter().for_each(|assumed| say::remark(&format!("assumed: {assumed}")));
}

/// What it is worked on with.
#[derive(Args)]
pub(crate) struct FilterArgument {
    /// The filter; `sinscal filters` describes them
    #[arg(long, value_name = "NAME", ignore_case = true, value_parser = filter())]
    filter: Arc<dyn AnyFilter>,
    #[command(flatten)]
    pub(crate) change: Change,
}

impl FilterArgument {
    /// The filter with what was added to it.
    pub(crate) fn filter(&self) -> Result<Arc<dyn AnyFilter>> {
        self.change.of(&self.filter)
    }
}

/// `filter` with the wander of the biases that the description of `log` states.
pub(crate) fn wandering(filter: &Arc<dyn AnyFilter>, log: &Log) -> Result<Arc<dyn AnyFilter>> {
    runs::wandering(filter, &log.description().wander)
        .map_err(|error| miette!("{}: the wander in [noise]: {error}", log.table().display()))
}

/// `filter` with what is not the unit's and may be wrong: considered where the description states by how much, and with `all` also where it
/// does not, by the defaults. What the filter has already stays as it is.
pub(crate) fn uncertain(
    filter: &Arc<dyn AnyFilter>,
    log: &Log,
    all: bool,
) -> Result<(Arc<dyn AnyFilter>, Vec<&'static str>)> {
    let stated = &log.description().uncertainty;
    let own = filter.blocks();
    let lacks = |name: &&'static str| own.iter().all(|leaf| leaf.name != *name);
    let is_stated = |name: &&'static str| stated.iter().any(|(stated, _)| stated == name);
    let every = if all { runs::influences(&**filter) } else { Vec::new() };
    let assumed: Vec<_> = every.into_iter().filter(|name| !is_stated(name)).collect();
    let names: Vec<_> = stated.iter().map(|(name, _)| *name).filter(lacks).chain(assumed.clone()).collect();
    Ok((considering(filter, &names)?, assumed))
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
