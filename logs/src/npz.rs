//! NumPy files: `.npz` as `numpy.savez` and `savez_compressed` write them, and a single array as `.npy`.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar};
use zip::ZipArchive;

use super::arrays::{Arrays, MOST_VARIABLES, Named};
use super::fault::LogError;
use super::guard::guarded;

/// What the only array of a `.npy` file is called.
const ARRAY: &str = "array";
/// No header of an array is longer, bytes: that of a table of many fields stays far below.
const LONGEST_HEADER: usize = 1 << 16;
/// Brackets in a header are not nested deeper.
const DEEPEST: usize = 6;

/// A NumPy file, its arrays listed.
pub(super) enum Numpy {
    Npz(Box<ZipArchive<BufReader<File>>>),
    Npy(PathBuf),
}

impl Numpy {
    /// Opens an archive and lists its arrays.
    pub(super) fn open_npz(path: &Path) -> Result<(Self, Vec<Named>), LogError> {
        let damaged = |problem: String| {
            LogError::file(path, format!("is not an archive of NumPy arrays, or damaged: {problem}"))
                .help("numpy.savez and numpy.savez_compressed write what is read here")
        };
        let file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        let mut archive = guarded(|| ZipArchive::new(BufReader::new(file))).map_err(damaged)?;
        if archive.len() > MOST_VARIABLES {
            return Err(damaged(format!("it holds more than {MOST_VARIABLES} files")));
        }
        let mut named = Vec::new();
        for index in 0..archive.len() {
            let (name, dims) = guarded(|| {
                let file = archive.by_index(index).map_err(|error| error.to_string())?;
                let name = file.name().map_err(|error| error.to_string())?.into_owned();
                Ok::<_, String>((name, describe(file)))
            })
            .map_err(damaged)?;
            let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
            named.push(Named { name, dims });
        }
        Ok((Self::Npz(Box::new(archive)), named))
    }

    /// Opens a single array.
    pub(super) fn open_npy(path: &Path) -> Result<(Self, Vec<Named>), LogError> {
        let file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        let dims = guarded(|| Ok::<_, String>(describe(BufReader::new(file)))).unwrap_or_else(Err);
        let named = Named { name: ARRAY.into(), dims };
        Ok((Self::Npy(path.to_owned()), vec![named]))
    }
}

impl Arrays for Numpy {
    fn read(&mut self, index: usize, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
        guarded(|| match self {
            Self::Npz(archive) => numbers(archive.by_index(index).map_err(|error| error.to_string())?, each),
            Self::Npy(path) => numbers(File::open(path).map_err(|error| error.to_string())?, each),
        })
        .map(drop)
    }
}

/// Reads the header, of bounded length whatever it announces.
fn header(bytes: &mut impl Read) -> Result<NpyHeader, String> {
    let mut start = [0; 12];
    let read = bytes.read_exact(&mut start);
    if read.is_err() || !start.starts_with(b"\x93NUMPY") {
        return Err("no NumPy array".into());
    }
    let announced = match start[6] {
        1 => usize::from(u16::from_le_bytes([start[8], start[9]])),
        _ => u32::from_le_bytes([start[8], start[9], start[10], start[11]]) as usize,
    };
    if announced > LONGEST_HEADER {
        return Err("an array with a damaged header".into());
    }
    // version 1 has two bytes of length
    let begun = if start[6] == 1 { 10 } else { 12 };
    let mut whole = start.to_vec();
    bytes
        .take((begun + announced).saturating_sub(start.len()) as u64)
        .read_to_end(&mut whole)
        .map_err(|error| error.to_string())?;
    // The parser of headers goes back and forth: its time doubles with each bracket in a bracket. Those of plain numbers have one
    // in one, `{'shape': (3, 4)}`, those of records two more.
    if deepest(&whole) > DEEPEST {
        return Err("an array with a damaged header".into());
    }
    NpyHeader::from_reader(whole.as_slice().chain(bytes))
        .map_err(|error| format!("a damaged array ({error})"))
}

/// How deep brackets stand in brackets.
fn deepest(header: &[u8]) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for byte in header {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

/// The dimensions of an array, or what it holds instead of numbers.
fn describe(mut bytes: impl Read) -> Result<Vec<u64>, String> {
    let header = header(&mut bytes)?;
    let holds = match header.dtype() {
        DType::Plain(kind) => match kind.type_char() {
            TypeChar::Int | TypeChar::Uint | TypeChar::Float if kind.num_bytes().is_some_and(|n| n <= 8) => {
                let mut dims = header.shape().to_vec();
                if header.order() == Order::Fortran {
                    dims.reverse();
                }
                return Ok(dims);
            }
            TypeChar::Complex => "complex values",
            TypeChar::Bool => "true/false values",
            TypeChar::ByteStr | TypeChar::UnicodeStr => "text",
            TypeChar::Object => "Python objects",
            TypeChar::DateTime | TypeChar::TimeDelta => "dates",
            _ => "values of an unusual type",
        },
        DType::Array(..) | DType::Record(_) => "a table of named fields: save each field as an array",
    };
    Err(holds.into())
}

/// Hands over the numbers of an array, and reads it to its end. Returns its dimensions as it tells them, and their order.
pub(super) fn numbers(
    mut bytes: impl Read,
    each: &mut dyn FnMut(f64) -> bool,
) -> Result<(Vec<u64>, Order), String> {
    let header = header(&mut bytes)?;
    let (dims, order) = (header.shape().to_vec(), header.order());
    let DType::Plain(kind) = header.dtype() else { return Err("it holds no plain numbers".into()) };
    let mut rest = BufReader::with_capacity(1 << 16, bytes);
    let file = NpyFile::with_header(header, &mut rest);
    let mut whole = true;
    macro_rules! numbers {
        ($kind:ty) => {
            for value in file.data::<$kind>().map_err(|error| error.to_string())? {
                if !each(value.map_err(|error| error.to_string())? as f64) {
                    whole = false;
                    break;
                }
            }
        };
    }
    match (kind.type_char(), kind.num_bytes()) {
        (TypeChar::Float, Some(8)) => numbers!(f64),
        (TypeChar::Float, Some(4)) => numbers!(f32),
        (TypeChar::Int, Some(8)) => numbers!(i64),
        (TypeChar::Int, Some(4)) => numbers!(i32),
        (TypeChar::Int, Some(2)) => numbers!(i16),
        (TypeChar::Int, Some(1)) => numbers!(i8),
        (TypeChar::Uint, Some(8)) => numbers!(u64),
        (TypeChar::Uint, Some(4)) => numbers!(u32),
        (TypeChar::Uint, Some(2)) => numbers!(u16),
        (TypeChar::Uint, Some(1)) => numbers!(u8),
        _ => return Err("half-precision or other numbers that are not read".into()),
    }
    // an archive tells at the end of an array whether its checksum is right
    match if whole { rest.read(&mut [0]) } else { Ok(0) } {
        Ok(0) => Ok((dims, order)),
        Ok(_) => Err("more follows the array: one array to a file is read".into()),
        Err(error) => Err(error.to_string()),
    }
}
