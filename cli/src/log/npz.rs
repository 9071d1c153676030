//! NumPy files: `.npz` as `numpy.savez` and `savez_compressed` write them, and a single array as `.npy`.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use zip::ZipArchive;

use super::arrays::{Arrays, MOST_VARIABLES, Named};
use super::fault::LogError;
use super::guard::guarded;

/// What the only array of a `.npy` file is called.
const ARRAY: &str = "array";
/// No header of an array is longer, bytes: that of a table of many fields stays far below.
const LONGEST_HEADER: usize = 1 << 16;

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
    }
}

/// What the header of an array says.
struct Header {
    /// The type as NumPy writes it, for instance `<f8`; none for a table of named fields.
    kind: Option<String>,
    column_major: bool,
    shape: Vec<u64>,
}

impl Header {
    /// Reads a header, of bounded length whatever it announces.
    fn read(bytes: &mut impl Read) -> Result<Self, String> {
        let mut start = [0; 10];
        if bytes.read_exact(&mut start).is_err() || !start.starts_with(b"\x93NUMPY") {
            return Err("no NumPy array".into());
        }
        let mut length = usize::from(u16::from_le_bytes([start[8], start[9]]));
        if start[6] > 1 {
            let mut rest = [0; 2];
            bytes.read_exact(&mut rest).map_err(|_| "a damaged array (it ends in its header)")?;
            length |= usize::from(u16::from_le_bytes(rest)) << 16;
        }
        if length > LONGEST_HEADER {
            return Err("an array with a damaged header".into());
        }
        let mut text = vec![0; length];
        bytes.read_exact(&mut text).map_err(|_| "a damaged array (it ends in its header)")?;
        let text = String::from_utf8_lossy(&text);
        Self::parse(&text).ok_or_else(|| format!("a damaged array (its header is {:?})", text.trim_end()))
    }

    /// The header is a dictionary in Python's notation: `{'descr': '<f8', 'fortran_order': False, 'shape': (9, 3), }`.
    fn parse(text: &str) -> Option<Self> {
        let entry = |key: &str| text.split_once(key).map(|(_, value)| value.trim_start());
        let kind = entry("'descr':")?;
        // a list of fields, each a pair of name and type
        let kind =
            if kind.starts_with('[') { None } else { Some(kind.strip_prefix('\'')?.split_once('\'')?.0) };
        let column_major = match entry("'fortran_order':")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return None,
        };
        let (shape, _) = entry("'shape':")?.strip_prefix('(')?.split_once(')')?;
        let lengths = shape.split(',').map(str::trim).filter(|length| !length.is_empty());
        // Python 2 ends them with an L
        let shape = lengths.map(|length| length.trim_end_matches('L').parse().ok()).collect::<Option<_>>()?;
        Some(Self { kind: kind.map(str::to_owned), column_major, shape })
    }

    /// Byte order, kind and size of the values; an error says what they are instead of numbers.
    fn numbers(&self) -> Result<(bool, char, usize), &'static str> {
        let Some(kind) = &self.kind else {
            return Err("a table of named fields: save each field as an array");
        };
        let mut characters = kind.chars();
        let order = characters.next();
        let kind = characters.next();
        match (kind, characters.as_str().parse()) {
            (Some(kind @ ('i' | 'u' | 'f')), Ok(size)) if size <= 8 => Ok((order == Some('>'), kind, size)),
            (Some('c'), _) => Err("complex values"),
            (Some('b'), _) => Err("true/false values"),
            (Some('S' | 'a' | 'U'), _) => Err("text"),
            (Some('O'), _) => Err("Python objects"),
            (Some('M' | 'm'), _) => Err("dates"),
            _ => Err("values of an unusual type"),
        }
    }
}

/// The dimensions of an array, or what it holds instead of numbers.
fn describe(mut bytes: impl Read) -> Result<Vec<u64>, String> {
    let header = Header::read(&mut bytes)?;
    header.numbers()?;
    let mut dims = header.shape;
    if header.column_major {
        dims.reverse();
    }
    Ok(dims)
}

/// Hands over the numbers of an array, in the order in which they stand in the file.
fn numbers(bytes: impl Read, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
    let mut bytes = BufReader::with_capacity(1 << 16, bytes);
    let header = Header::read(&mut bytes)?;
    let (big_endian, kind, size) = header.numbers()?;
    let value: fn([u8; 8]) -> f64 = match (kind, size) {
        ('f', 8) => f64::from_le_bytes,
        ('f', 4) => |[a, b, c, d, ..]| f32::from_le_bytes([a, b, c, d]).into(),
        ('i', 8) => |all| i64::from_le_bytes(all) as f64,
        ('i', 4) => |[a, b, c, d, ..]| i32::from_le_bytes([a, b, c, d]).into(),
        ('i', 2) => |[a, b, ..]| i16::from_le_bytes([a, b]).into(),
        ('i', 1) => |[a, ..]| i8::from_le_bytes([a]).into(),
        // the bytes that are not there are zero
        ('u', 8 | 4 | 2 | 1) => |all| u64::from_le_bytes(all) as f64,
        _ => return Err("half-precision or other numbers that are not read".into()),
    };
    let count = header.shape.iter().try_fold(1_u64, |count, length| count.checked_mul(*length));
    for _ in 0..count.ok_or("an array with a damaged header")? {
        let mut cell = [0; 8];
        let here = &mut cell[..size];
        bytes.read_exact(here).map_err(|error| error.to_string())?;
        if big_endian {
            here.reverse();
        }
        if !each(value(cell)) {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(header: &str, values: &[u8]) -> Vec<u8> {
        let length = u16::try_from(header.len()).expect("short");
        [b"\x93NUMPY\x01\x00", length.to_le_bytes().as_slice(), header.as_bytes(), values].concat()
    }

    fn read(header: &str, values: &[u8]) -> Result<(Vec<u64>, Vec<f64>), String> {
        let file = array(header, values);
        let dims = describe(file.as_slice())?;
        let mut read = Vec::new();
        numbers(file.as_slice(), &mut |value| {
            read.push(value);
            true
        })?;
        Ok((dims, read))
    }

    #[test]
    fn headers_as_numpy_writes_them() {
        let of = |kind: &str, order: &str, shape: &str| {
            format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}   \n")
        };
        let two = [1.5_f64.to_le_bytes(), (-2.0_f64).to_le_bytes()].concat();
        assert_eq!(read(&of("'<f8'", "False", "(2, 1)"), &two), Ok((vec![2, 1], vec![1.5, -2.0])));
        assert_eq!(read(&of("'<f8'", "True", "(2, 1)"), &two), Ok((vec![1, 2], vec![1.5, -2.0])));
        assert_eq!(
            read(&of("'>i2'", "False", "(2,)"), &[0xff, 0xfe, 1, 0]),
            Ok((vec![2], vec![-2.0, 256.0]))
        );
        assert_eq!(read(&of("'|u1'", "False", "(3L,)"), &[0, 7, 255]), Ok((vec![3], vec![0.0, 7.0, 255.0])));
        assert_eq!(read(&of("'<f4'", "False", "()"), &0.5_f32.to_le_bytes()), Ok((vec![], vec![0.5])));
        for (kind, shape, problem) in [
            ("'|b1'", "(2,)", "true/false values"),
            ("'<U7'", "(2,)", "text"),
            ("'<M8[ns]'", "(2,)", "dates"),
            ("[('a', '<f8'), ('b', '<f8')]", "(2,)", "named fields"),
            ("'<f2'", "(2,)", "half-precision"),
            ("'<f8'", "(3,)", "fill"),
            ("'<f8'", "(-3,)", "damaged"),
            ("'<f8'", "(18446744073709551615, 9)", "damaged"),
            ("f8", "(3,)", "damaged"),
        ] {
            let refused = read(&of(kind, "False", shape), &two).expect_err(kind);
            assert!(refused.contains(problem), "{kind} {shape}: {refused}");
        }
    }
}
