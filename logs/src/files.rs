//! The files of a log: which they are, by their endings, and which build reads them.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::arrays::{self, Arrays, Memory, Named};
use super::fault::LogError;
use super::layout::{Asked, Layout};
use super::unreadable;

/// What a description holds at least.
pub(super) const LEAST: &str =
    "at least: [imu] with rate_hz, and [site] with latitude_deg, longitude_deg, height_m";

/// What kind of file a table is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Parquet,
    Csv,
    Mat,
    Hdf5,
    Npz,
    Npy,
    Mcap,
    Bag,
    Ulog,
}

/// The ending says what kind of file a table is.
const ENDINGS: [(&str, Kind); 11] = [
    ("parquet", Kind::Parquet),
    ("csv", Kind::Csv),
    ("mat", Kind::Mat),
    ("h5", Kind::Hdf5),
    ("hdf5", Kind::Hdf5),
    ("npz", Kind::Npz),
    ("npy", Kind::Npy),
    ("mcap", Kind::Mcap),
    ("bag", Kind::Bag),
    ("ulg", Kind::Ulog),
    ("ulog", Kind::Ulog),
];

/// Endings of tables of text beside `.csv`, which goes before them where a log is named without.
const TEXTS: [&str; 5] = ["txt", "log", "dat", "tsv", "asc"];

/// Reads a file of arrays.
pub(super) fn load(path: &Path, kind: Kind, asked: Asked<'_>) -> Result<(Memory, Layout), LogError> {
    // MATLAB's v7.3 is HDF5 under another name
    let kind = if kind == Kind::Mat && is_hdf5(path)? { Kind::Hdf5 } else { kind };
    let (mut file, named) = open(path, kind)?;
    arrays::load(path, named, file.as_mut(), asked)
}

/// Opens a file of arrays, if this build can, and lists them.
fn open(path: &Path, kind: Kind) -> Result<(Box<dyn Arrays>, Vec<Named>), LogError> {
    #[cfg(any(
        feature = "mat",
        feature = "hdf5",
        feature = "npz",
        feature = "mcap",
        feature = "bag",
        feature = "ulog"
    ))]
    fn boxed<T: Arrays + 'static>((file, named): (T, Vec<Named>)) -> (Box<dyn Arrays>, Vec<Named>) {
        (Box::new(file), named)
    }
    let (what, feature, or) = match kind {
        #[cfg(feature = "mat")]
        Kind::Mat => return super::mat5::Mat5::open(path).map(boxed),
        #[cfg(feature = "hdf5")]
        Kind::Hdf5 => return super::hdf5::Hdf5::open(path).map(boxed),
        #[cfg(feature = "npz")]
        Kind::Npz => return super::npz::Numpy::open_npz(path).map(boxed),
        #[cfg(feature = "npz")]
        Kind::Npy => return super::npz::Numpy::open_npy(path).map(boxed),
        #[cfg(feature = "mcap")]
        Kind::Mcap => return super::topics::mcap::open(path).map(boxed),
        #[cfg(feature = "bag")]
        Kind::Bag => return super::topics::bag::open(path).map(boxed),
        #[cfg(feature = "ulog")]
        Kind::Ulog => return super::topics::ulog::open(path).map(boxed),
        #[cfg(not(feature = "mcap"))]
        Kind::Mcap => ("MCAP", "mcap", "or"),
        #[cfg(not(feature = "bag"))]
        Kind::Bag => ("bags of ROS 1", "bag", "or"),
        #[cfg(not(feature = "ulog"))]
        Kind::Ulog => ("ULog", "ulog", "or"),
        #[cfg(not(feature = "hdf5"))]
        Kind::Hdf5 => ("HDF5, as MATLAB's v7.3 is", "hdf5", "save it in MATLAB with `save -v7`, or"),
        #[cfg(not(feature = "mat"))]
        Kind::Mat => ("MATLAB files", "mat", "or"),
        _ => ("NumPy files", "npz", "or"),
    };
    let help = format!(
        "`cargo build --release -p sinscal-cli --features {feature}` builds a program that does; {or} write it as CSV or \
         Parquet"
    );
    Err(LogError::file(path, format!("this build of the program does not read {what}")).help(help))
}

/// Whether a MATLAB file is HDF5: of version 2 by its header, or without such a header.
fn is_hdf5(path: &Path) -> Result<bool, LogError> {
    let mut start = Vec::new();
    std::fs::File::open(path)
        .and_then(|file| file.take(128).read_to_end(&mut start))
        .map_err(|error| unreadable(path, &error))?;
    Ok(start.starts_with(b"\x89HDF") || start.ends_with(b"\x00\x02IM") || start.ends_with(b"\x02\x00MI"))
}

/// What the ending of a file says it is.
fn kind(path: &Path) -> Option<Kind> {
    let ending = path.extension()?.to_str()?;
    let text = TEXTS.contains(&ending).then_some(Kind::Csv);
    ENDINGS.iter().find(|(known, _)| *known == ending).map(|(_, kind)| *kind).or(text)
}

/// A file of a reference, named in a description beside which it lies, and its kind.
pub(super) fn beside(description: &Path, name: &str) -> Result<(PathBuf, Kind), LogError> {
    let path = description.parent().unwrap_or(Path::new("")).join(name);
    let Some(kind) = kind(&path) else {
        let help = "its ending must be that of a table: .csv, .txt, .parquet, .mat, .h5, .npz ...";
        return Err(LogError::file(&path, "is no table by its ending").help(help));
    };
    match std::fs::metadata(&path) {
        Ok(metadata) if metadata.is_file() => Ok((path, kind)),
        Ok(_) => Err(LogError::file(&path, "is not a regular file: the reference was expected")),
        Err(error) => Err(unreadable(&path, &error)),
    }
}

/// The table and its kind of the log called `log`, and where its description is, or would be.
pub(super) fn find(log: &Path) -> Result<(PathBuf, Kind, PathBuf), LogError> {
    let ending = log.extension().and_then(|ending| ending.to_str());
    let text = ending.and_then(|ending| TEXTS.iter().find(|known| **known == ending));
    let text = text.map(|ending| (*ending, Kind::Csv)).filter(|_| log.is_file());
    let named = ENDINGS.iter().copied().find(|(known, _)| Some(*known) == ending).or(text);
    let stem =
        if named.is_some() || ending == Some("toml") { log.with_extension("") } else { log.to_owned() };
    let with = |ending: &str| {
        let mut name = stem.clone().into_os_string();
        name.push(".");
        name.push(ending);
        PathBuf::from(name)
    };
    let of = |endings: &[(&str, Kind)]| -> Vec<(PathBuf, Kind)> {
        endings
            .iter()
            .map(|(ending, kind)| (with(ending), *kind))
            .filter(|(path, _)| is_there(path))
            .collect()
    };
    let mut there = of(&ENDINGS);
    if there.is_empty() {
        there = of(&TEXTS.map(|ending| (ending, Kind::Csv)));
    }
    let mut there = there.into_iter();
    let (table, kind) = match (named, there.next(), there.next()) {
        (Some((ending, kind)), ..) => (with(ending), kind),
        (None, Some((first, _)), Some((second, _))) => {
            let problem = format!("there is both {} and {}", first.display(), second.display());
            return Err(LogError::file(log, problem).help("name the one to read with its ending"));
        }
        (None, Some(only), None) => only,
        (None, None, _) => {
            let problem = format!(
                "there is neither {} nor {}, nor one that ends in .mat, .h5, .hdf5, .npz, .npy, .mcap, .bag or .ulg",
                with("parquet").display(),
                with("csv").display()
            );
            let endings = "the ending of a table must be .parquet, .csv, .txt, .log, .dat, .tsv, .mat, .h5, .hdf5, .npz, .npy, .mcap, .bag or .ulg";
            let help = if let Some(other) = otherwise_spelled(&stem) {
                Some(format!("there is {}: endings are written in small letters", other.display()))
            } else {
                (log.is_file() && ending != Some("toml")).then(|| endings.to_owned())
            };
            return Err(LogError::file(log, problem).help_if(help));
        }
    };
    check_file(&table, "table of samples", None)?;
    Ok((table, kind, with("toml")))
}

/// Whether a file is there, and is one.
pub(super) fn check_file(path: &Path, what: &str, help: Option<&str>) -> Result<(), LogError> {
    let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound if path.is_symlink() => {
            LogError::file(path, format!("is a link to nothing: the {what} was expected"))
        }
        io::ErrorKind::NotFound => {
            LogError::file(path, format!("the {what} is not there")).help_if(help.map(str::to_owned))
        }
        _ => unreadable(path, &error),
    })?;
    if !metadata.is_file() {
        return Err(LogError::file(path, format!("is not a regular file: the {what} was expected")));
    }
    Ok(())
}

/// A file whose ending is one of a table but for capital letters.
fn otherwise_spelled(stem: &Path) -> Option<PathBuf> {
    let spelled = |path: &PathBuf| {
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        let known = |(known, _): &(&str, Kind)| ending.as_deref() == Some(*known);
        path.file_stem() == stem.file_name() && ENDINGS.iter().any(known)
    };
    let folder = stem.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(stem.with_file_name(entry.ok()?.file_name())))
        .find(spelled)
}

/// Whether there is something by this name, were it a link to nothing.
fn is_there(path: &Path) -> bool {
    path.exists() || path.is_symlink()
}
