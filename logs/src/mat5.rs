//! MATLAB files as `save -v6` and `save -v7` write them (level 5, plain or compressed), and SciPy's `savemat`.
//!
//! Written here because the crates that read them stumble over what stands beside the log in a workspace: matfile 0.5 refuses
//! a file with an int32 variable or an object in it, matrw 0.1 panics on a struct that SciPy wrote, and both unpack without
//! bound. What a log needs is little: the header of each variable, and the numbers of a few real arrays. Reference: MAT-File
//! Format, The MathWorks (level 5).

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom, Take, Write as _};
use std::path::Path;

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::arrays::{Arrays, MOST_VARIABLES, Named};
use super::fault::LogError;
use super::rewrite::arrays::Changes;

/// Bytes before the first variable.
const HEADER: u64 = 128;
/// No name and no list of dimensions is longer, bytes.
const LONGEST: u32 = 4096;

/// Structs within structs.
const DEEPEST: usize = 3;
/// No struct of a log is longer, unpacked, bytes.
const LARGEST: u64 = 4 << 30;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Class of an object, whose header has no dimensions.
const OPAQUE: u32 = 17;
const STRUCT: u32 = 2;
/// Class of an array in double precision.
const DOUBLE: u32 = 6;

/// A MATLAB file, its variables listed.
pub(super) struct Mat5 {
    file: File,
    big_endian: bool,
    elements: Vec<Element>,
}

/// Where a variable stands.
#[derive(Clone, Copy)]
struct Element {
    offset: u64,
    size: u64,
    compressed: bool,
    /// Bytes of its contents, unpacked, before what is meant: a field of a struct.
    within: u64,
}

impl Mat5 {
    /// Opens a file and lists its variables.
    pub(super) fn open(path: &Path) -> Result<(Self, Vec<Named>), LogError> {
        let failed = |error: std::io::Error| super::unreadable(path, &error);
        let mut file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let mut header = [0; HEADER as usize];
        let whole = file.read_exact(&mut header).is_ok();
        let big_endian = match (&header[124..126], &header[126..]) {
            ([0, 1], b"IM") if whole => false,
            ([1, 0], b"MI") if whole => true,
            _ => {
                let problem = "is not a MATLAB file of version 5 to 7.3, or cut off";
                let help = "write it with `save -v7` in MATLAB, or scipy.io.savemat";
                return Err(LogError::file(path, problem).help(help));
            }
        };
        let mut mat = Self { file, big_endian, elements: Vec::new() };
        let mut named = Vec::new();
        let mut offset = HEADER;
        while offset < length {
            let place =
                format!("the variable after {}", named.last().map_or("the header", |n: &Named| &n.name));
            let fault = |problem: String| {
                let help = "write the file again; MATLAB writes what is read here with `save -v7`";
                LogError::file(path, format!("{place} cannot be read: {problem}")).help(help)
            };
            if mat.elements.len() == MOST_VARIABLES {
                return Err(fault(format!("there are more than {MOST_VARIABLES} variables")));
            }
            let element = mat.element(offset, length).map_err(fault)?;
            offset = element.offset + element.size;
            let mut fields = Vec::new();
            let head = mat
                .with(element, |reader| {
                    let head = reader.head()?;
                    if head.is_one_struct() {
                        reader.fields(&head.name, 1, &mut fields)?;
                    }
                    Ok(head)
                })
                .map_err(fault)?;
            if head.name.is_empty() {
                // what MATLAB keeps for itself
                continue;
            }
            mat.elements.push(element);
            named.push(head.named());
            if mat.elements.len() + fields.len() > MOST_VARIABLES {
                return Err(fault(format!("there are more than {MOST_VARIABLES} variables")));
            }
            for (within, field) in fields {
                mat.elements.push(Element { within, ..element });
                named.push(field);
            }
        }
        Ok((mat, named))
    }

    /// The element at an offset, whose tag is whole and which ends within the file.
    fn element(&mut self, offset: u64, length: u64) -> Result<Element, String> {
        self.file.seek(SeekFrom::Start(offset)).map_err(|error| error.to_string())?;
        let mut reader = Reader { bytes: &mut self.file, big_endian: self.big_endian, read: 0 };
        let tag = reader.tag()?;
        let (start, size) = (offset + 8, u64::from(tag.size));
        match tag.kind {
            _ if tag.small.is_some() || start.saturating_add(size) > length => Err("it is cut off".into()),
            MATRIX | COMPRESSED => {
                Ok(Element { offset: start, size, compressed: tag.kind == COMPRESSED, within: 0 })
            }
            kind => Err(format!("it is of the unknown kind {kind}")),
        }
    }

    /// Reads in the contents of a variable, unpacked, or of a field of it.
    fn with<T>(
        &mut self,
        element: Element,
        read: impl FnOnce(&mut Reader<&mut dyn Read>) -> Result<T, String>,
    ) -> Result<T, String> {
        self.file.seek(SeekFrom::Start(element.offset)).map_err(|error| error.to_string())?;
        let bytes: Take<&mut File> = (&mut self.file).take(element.size);
        let big_endian = self.big_endian;
        let mut packed;
        let mut plain;
        let bytes: &mut dyn Read = if element.compressed {
            packed = BufReader::with_capacity(1 << 16, ZlibDecoder::new(BufReader::new(bytes)));
            if (Reader { bytes: &mut packed as &mut dyn Read, big_endian, read: 0 }).tag()?.kind != MATRIX {
                return Err("it holds no variable".into());
            }
            &mut packed
        } else {
            plain = BufReader::with_capacity(1 << 16, bytes);
            &mut plain
        };
        let mut reader = Reader { bytes, big_endian, read: 0 };
        reader.skip(element.within)?;
        read(&mut reader)
    }
}

/// A file with other numbers in some of its variables; everything else is copied as it stands.
pub(super) fn rewritten(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let (mut mat, named) = Mat5::open(path).map_err(|error| error.to_string())?;
    let io = |error: std::io::Error| error.to_string();
    let mut written = Vec::new();
    let mut copied = 0;
    let elements = mat.elements.clone();
    for (index, (element, named)) in elements.iter().zip(&named).enumerate().filter(|(i, _)| changes.has(*i))
    {
        if element.within > 0 {
            return Err(format!("{} is a field of a struct, which is not written", named.name));
        }
        let dims = named.dims.clone()?;
        let mut numbers = Vec::new();
        mat.read(index, &mut |number| {
            numbers.push(number);
            true
        })?;
        changes.apply(index, &dims, &mut numbers)?;
        // its tag stands before it
        let start = element.offset - 8;
        mat.file.seek(SeekFrom::Start(copied)).map_err(io)?;
        std::io::copy(&mut (&mut mat.file).take(start - copied), &mut written).map_err(io)?;
        let array = mat.array(&named.name, &dims, &numbers)?;
        if element.compressed {
            let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
            packed.write_all(&array).map_err(io)?;
            let packed = packed.finish().map_err(io)?;
            mat.tag(COMPRESSED, packed.len(), &mut written)?;
            written.extend(packed);
        } else {
            written.extend(array);
        }
        copied = element.offset + element.size;
    }
    mat.file.seek(SeekFrom::Start(copied)).map_err(io)?;
    std::io::copy(&mut mat.file, &mut written).map_err(io)?;
    Ok(written)
}

impl Mat5 {
    fn u32(&self, number: u32) -> [u8; 4] {
        if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    fn tag(&self, kind: u32, size: usize, written: &mut Vec<u8>) -> Result<(), String> {
        let size = u32::try_from(size).map_err(|_| "it is too large for a file of this kind".to_owned())?;
        written.extend(self.u32(kind));
        written.extend(self.u32(size));
        Ok(())
    }

    /// A variable of numbers in double precision; dimensions come the slowest first.
    fn array(&self, name: &str, dims: &[u64], numbers: &[f64]) -> Result<Vec<u8>, String> {
        let mut contents = Vec::with_capacity(8 * numbers.len() + 128);
        let part = |kind: u32, bytes: &[u8], contents: &mut Vec<u8>| {
            self.tag(kind, bytes.len(), contents)?;
            contents.extend(bytes);
            contents.resize(contents.len().next_multiple_of(8), 0);
            Ok::<(), String>(())
        };
        let flags = [self.u32(DOUBLE), self.u32(0)].concat();
        part(6, &flags, &mut contents)?;
        let sides = dims.iter().rev().map(|side| u32::try_from(*side).map(|side| self.u32(side)));
        let sides = sides.collect::<Result<Vec<_>, _>>().map_err(|_| "it is too large".to_owned())?;
        part(5, &sides.concat(), &mut contents)?;
        part(1, name.as_bytes(), &mut contents)?;
        self.tag(9, 8 * numbers.len(), &mut contents)?;
        let number = |number: &f64| if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        contents.extend(numbers.iter().flat_map(number));
        let mut written = Vec::with_capacity(contents.len() + 8);
        self.tag(MATRIX, contents.len(), &mut written)?;
        written.extend(contents);
        Ok(written)
    }
}

impl Arrays for Mat5 {
    fn read(&mut self, index: usize, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
        let element = *self.elements.get(index).ok_or("it is not there")?;
        self.with(element, |reader| {
            reader.head()?;
            reader.numbers(each)
        })
    }
}

/// What stands before the contents of a variable.
struct Head {
    name: String,
    class: u32,
    complex: bool,
    logical: bool,
    /// Fastest first.
    dims: Vec<u64>,
}

impl Head {
    fn is_one_struct(&self) -> bool {
        self.class == STRUCT && self.dims.iter().all(|side| *side == 1)
    }

    fn named(self) -> Named {
        let holds = match self.class {
            1 => "cells",
            2 => "a struct",
            3 | OPAQUE => "an object, such as a table or a datetime",
            4 => "text",
            5 => "a sparse matrix",
            6..=15 if self.complex => "complex values",
            6..=15 if self.logical => "true/false values",
            6..=15 => return Named { name: self.name, dims: Ok(self.dims.into_iter().rev().collect()) },
            _ => "no array",
        };
        Named { name: self.name, dims: Err(holds.into()) }
    }
}

/// The beginning of an element; up to four bytes of contents may stand in it.
struct Tag {
    kind: u32,
    size: u32,
    small: Option<[u8; 4]>,
}

/// Reads elements.
struct Reader<R> {
    bytes: R,
    big_endian: bool,
    /// Bytes so far.
    read: u64,
}

impl<R: Read> Reader<R> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        self.bytes.read_exact(&mut bytes).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => "it is cut off".to_owned(),
            _ => error.to_string(),
        })?;
        self.read += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self, bytes: u64) -> Result<(), String> {
        if self.read.saturating_add(bytes) > LARGEST {
            return Err("a struct is too large".into());
        }
        let mut skipped = (&mut self.bytes).take(bytes);
        let skipped = std::io::copy(&mut skipped, &mut std::io::sink()).map_err(|error| error.to_string())?;
        self.read += skipped;
        if skipped == bytes { Ok(()) } else { Err("it is cut off".into()) }
    }

    /// The fields of a struct whose header was read, those of structs in it too, by their names and where their headers begin.
    fn fields(&mut self, of: &str, depth: usize, fields: &mut Vec<(u64, Named)>) -> Result<(), String> {
        let length = self.short(&[5])?;
        let length = length.first_chunk().map_or(0, |length| self.u32(*length)) as usize;
        let names = self.short(&[1])?;
        if length == 0 || names.len() > MOST_VARIABLES * length {
            return Err("its header is damaged".into());
        }
        for name in names.chunks(length) {
            let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
            let name = format!("{of}.{}", String::from_utf8_lossy(name));
            let tag = self.tag()?;
            if tag.kind != MATRIX || tag.small.is_some() {
                return Err(format!("its field {name} is of the unknown kind {}", tag.kind));
            }
            let (start, end) = (self.read, self.read + u64::from(tag.size));
            // an empty field has no header
            if tag.size > 0 {
                let head = self.head()?;
                let nested = head.is_one_struct() && depth < DEEPEST;
                let named = Named { name: name.clone(), ..head.named() };
                fields.push((start, named));
                if fields.len() > MOST_VARIABLES {
                    return Err(format!("there are more than {MOST_VARIABLES} variables"));
                }
                if nested {
                    self.fields(&name, depth + 1, fields)?;
                }
            }
            self.skip(end.checked_sub(self.read).ok_or("its header is damaged")?)?;
        }
        Ok(())
    }

    fn u32(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    fn tag(&mut self) -> Result<Tag, String> {
        let first = self.bytes()?;
        let second = self.bytes()?;
        let (kind, size) = (self.u32(first), self.u32(second));
        Ok(match kind >> 16 {
            0 => Tag { kind, size, small: None },
            size => Tag { kind: kind & 0xffff, size, small: Some(second) },
        })
    }

    /// The contents of a short element of one of these kinds.
    fn short(&mut self, kinds: &[u32]) -> Result<Vec<u8>, String> {
        let tag = self.tag()?;
        if !kinds.contains(&tag.kind) || tag.size > if tag.small.is_some() { 4 } else { LONGEST } {
            return Err("its header is damaged".into());
        }
        let size = tag.size as usize;
        if let Some(small) = tag.small {
            return Ok(small.into_iter().take(size).collect());
        }
        let mut contents = vec![0; size.next_multiple_of(8)];
        self.bytes.read_exact(&mut contents).map_err(|_| "it is cut off")?;
        self.read += contents.len() as u64;
        contents.truncate(size);
        Ok(contents)
    }

    fn head(&mut self) -> Result<Head, String> {
        let flags = self.short(&[6])?;
        let Some(flags) = flags.first_chunk().map(|flags| self.u32(*flags)) else {
            return Err("its header is damaged".into());
        };
        let class = flags & 0xff;
        // kinds of signed and unsigned integers, of text in bytes and in UTF-8
        let dims = if class == OPAQUE { Vec::new() } else { self.short(&[5, 6])? };
        let name = self.short(&[1, 2, 16])?;
        Ok(Head {
            name: String::from_utf8_lossy(&name).into_owned(),
            class,
            complex: flags & 0x800 != 0,
            logical: flags & 0x200 != 0,
            dims: dims.as_chunks().0.iter().map(|dim| u64::from(self.u32(*dim))).collect(),
        })
    }

    /// The numbers of an array; MATLAB stores each array in the smallest type that holds its numbers.
    fn numbers(&mut self, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
        let tag = self.tag()?;
        macro_rules! numbers {
            ($kind:ty) => {
                self.all::<{ size_of::<$kind>() }>(&tag, each, |bytes, big_endian| {
                    (if big_endian { <$kind>::from_be_bytes(bytes) } else { <$kind>::from_le_bytes(bytes) })
                        as f64
                })
            };
        }
        match tag.kind {
            1 => numbers!(i8),
            2 => numbers!(u8),
            3 => numbers!(i16),
            4 => numbers!(u16),
            5 => numbers!(i32),
            6 => numbers!(u32),
            7 => numbers!(f32),
            9 => numbers!(f64),
            12 => numbers!(i64),
            13 => numbers!(u64),
            _ => Err("its numbers are of an unknown kind".into()),
        }
    }

    fn all<const N: usize>(
        &mut self,
        tag: &Tag,
        each: &mut dyn FnMut(f64) -> bool,
        number: fn([u8; N], bool) -> f64,
    ) -> Result<(), String> {
        if let Some(small) = tag.small {
            let small = small.get(..tag.size as usize).ok_or("its header is damaged")?;
            let mut numbers = small.as_chunks().0.iter().map(|bytes| number(*bytes, self.big_endian));
            let _ = numbers.all(each);
            return Ok(());
        }
        for _ in 0..tag.size as usize / N {
            let bytes = self.bytes()?;
            if !each(number(bytes, self.big_endian)) {
                break;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rewrite::arrays::{change, changed};

    type Done = Result<(), Box<dyn std::error::Error>>;

    const ROWS: usize = 5;

    /// A file of two arrays of three columns, and what MATLAB keeps for itself between them.
    fn file(big_endian: bool, compressed: bool) -> Result<Vec<u8>, String> {
        let empty = tempfile::tempfile().map_err(|error| error.to_string())?;
        let mat = Mat5 { file: empty, big_endian, elements: Vec::new() };
        let mut file = vec![b' '; 124];
        file.extend(if big_endian { *b"\x01\x00MI" } else { *b"\x00\x01IM" });
        let numbers: Vec<f64> = (0..3 * ROWS).map(|k| 0.25 * k as f64).collect();
        let by_column = mat.array("wm", &[3, ROWS as u64], &numbers)?;
        let lying = mat.array("vm", &[ROWS as u64, 3], &numbers)?;
        for array in [by_column, mat.array("", &[1, 1], &[7.0])?, lying] {
            if compressed {
                let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
                packed.write_all(&array).map_err(|error| error.to_string())?;
                let packed = packed.finish().map_err(|error| error.to_string())?;
                mat.tag(COMPRESSED, packed.len(), &mut file)?;
                file.extend(packed);
            } else {
                file.extend(array);
            }
        }
        Ok(file)
    }

    /// Name, dimensions and numbers.
    type Array = (String, Vec<u64>, Vec<f64>);

    fn arrays(path: &Path) -> Result<Vec<Array>, String> {
        let (mut mat, named) = Mat5::open(path).map_err(|error| error.to_string())?;
        let mut all = Vec::new();
        for (index, named) in named.into_iter().enumerate() {
            let mut numbers = Vec::new();
            mat.read(index, &mut |number| {
                numbers.push(number);
                true
            })?;
            all.push((named.name, named.dims?, numbers));
        }
        Ok(all)
    }

    #[test]
    fn variables_change_in_either_order_of_bytes_packed_or_not() -> Done {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("log.mat");
        for (big_endian, compressed) in [(false, false), (false, true), (true, false), (true, true)] {
            std::fs::write(&path, file(big_endian, compressed)?)?;
            let mut expected = arrays(&path)?;
            for row in 0..ROWS {
                expected[0].2[2 * ROWS + row] += change(0, 2, row);
                expected[1].2[3 * row + 1] += change(1, 1, row);
            }
            let out = changed(&path, rewritten, ROWS, &[(0, 2), (1, 1)])?;
            std::fs::write(&path, out)?;
            assert_eq!(arrays(&path)?, expected, "{big_endian} {compressed}");
        }
        Ok(())
    }

    #[test]
    fn what_does_not_change_is_copied_to_the_byte() -> Done {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("log.mat");
        let before = file(false, true)?;
        std::fs::write(&path, &before)?;
        assert_eq!(changed(&path, rewritten, 0, &[])?, before);
        Ok(())
    }
}
