//! Looking over the pages of a Parquet file before they are unpacked: a page says how large it becomes, and the decoder makes room
//! for that, whatever it says. A damaged or malicious file of a kilobyte must not ask for the memory of a machine.
//!
//! A page begins with a header in Thrift's compact protocol (`PageHeader` of the Parquet format); of it only three numbers are
//! read here, the rest is skipped.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom, Take};

/// Pages of a log unpack to no more than this, bytes. Writers make pages of about 1 MiB; one is unpacked at a time for each column.
const LARGEST: i64 = 32 << 20;
/// Structures in a header are nested no deeper.
const DEEPEST: u32 = 8;

/// What a page says of itself.
#[derive(Default)]
struct Page {
    unpacked: i64,
    packed: i64,
    /// Number of entries, if it is a dictionary.
    dictionary: i64,
}

/// Walks over the pages of a column, which take `length` bytes from `start`.
pub(super) fn check(file: &mut File, start: u64, length: u64) -> Result<(), String> {
    let size = file.metadata().map_err(|error| error.to_string())?.len();
    let end = start
        .checked_add(length)
        .filter(|end| *end <= size)
        .ok_or("its pages would lie beyond the end of the file")?;
    let mut at = start;
    while at < end {
        file.seek(SeekFrom::Start(at)).map_err(|error| error.to_string())?;
        let mut header = Thrift { bytes: BufReader::with_capacity(512, (&*file).take(end - at)), read: 0 };
        let page = header.page().ok_or("the header of a page is damaged")?;
        at += header.read;
        let left = end - at;
        let packed = u64::try_from(page.packed).ok().filter(|packed| *packed <= left);
        at += packed.ok_or("a page would lie beyond the end of the column")?;
        if !(0..=LARGEST).contains(&page.unpacked) {
            let size = page.unpacked >> 20;
            return Err(format!(
                "a page says it unpacks to {size} MiB, and up to {} MiB are read",
                LARGEST >> 20
            ));
        }
        // a number takes at least a byte
        if !(0..=page.unpacked).contains(&page.dictionary) {
            let Page { dictionary, unpacked, .. } = page;
            return Err(format!("a dictionary says it holds {dictionary} numbers in {unpacked} bytes"));
        }
    }
    Ok(())
}

/// Thrift's compact protocol, as far as a header needs it; nothing where it is damaged.
struct Thrift<'a> {
    bytes: BufReader<Take<&'a File>>,
    read: u64,
}

/// Kinds of values.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCT: u8 = 12;

impl Thrift<'_> {
    fn page(&mut self) -> Option<Page> {
        let mut page = Page::default();
        self.structure(0, &mut |thrift, field, kind| match (field, kind) {
            (2, I16..=I64) => thrift.integer().map(|size| page.unpacked = size),
            (3, I16..=I64) => thrift.integer().map(|size| page.packed = size),
            (7, STRUCT) => thrift.structure(1, &mut |thrift, field, kind| match (field, kind) {
                (1, I16..=I64) => thrift.integer().map(|entries| page.dictionary = entries),
                _ => thrift.skip(kind, 1),
            }),
            _ => thrift.skip(kind, 0),
        })?;
        Some(page)
    }

    /// Reads a structure field by field.
    fn structure(
        &mut self,
        depth: u32,
        field: &mut dyn FnMut(&mut Self, i64, u8) -> Option<()>,
    ) -> Option<()> {
        if depth >= DEEPEST {
            return None;
        }
        let mut id = 0_i64;
        loop {
            let head = self.byte()?;
            let kind = head & 0xf;
            if kind == 0 {
                return Some(());
            }
            id = match head >> 4 {
                0 => self.integer()?,
                step => id.checked_add(step.into())?,
            };
            field(self, id, kind)?;
        }
    }

    fn skip(&mut self, kind: u8, depth: u32) -> Option<()> {
        match kind {
            _ if depth > DEEPEST => None,
            TRUE | FALSE => Some(()),
            BYTE => self.byte().map(drop),
            I16..=I64 => self.integer().map(drop),
            DOUBLE => (0..8).try_for_each(|_| self.byte().map(drop)),
            BINARY => (0..self.varint()?).try_for_each(|_| self.byte().map(drop)),
            LIST | SET => {
                let head = self.byte()?;
                let length = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                // in a list a truth value takes a byte
                let kind = if head & 0xf <= FALSE { BYTE } else { head & 0xf };
                (0..length).try_for_each(|_| self.skip(kind, depth + 1))
            }
            STRUCT => self.structure(depth + 1, &mut |thrift, _, kind| thrift.skip(kind, depth + 1)),
            _ => None,
        }
    }

    fn byte(&mut self) -> Option<u8> {
        let mut byte = [0];
        self.bytes.read_exact(&mut byte).ok()?;
        self.read += 1;
        Some(byte[0])
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// Zigzag: 0, -1, 1, -2 ...
    fn integer(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}
