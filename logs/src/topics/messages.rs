//! Messages of ROS, as ROS 1 and ROS 2 (CDR) write them, as far as they say something about motion.

use super::{Rewriting, Topics};

/// What comes one after the other in a message, behind its header.
#[derive(Clone, Copy)]
enum Part {
    /// So many numbers.
    Numbers(&'static str, usize),
    /// A quaternion x, y, z, w; it is kept as w, x, y, z.
    Quaternion(&'static str),
    /// A small integer and one of two bytes that does not matter.
    Status(&'static str),
    /// So many numbers that do not matter.
    Skipped(usize),
    Text,
}
use Part::{Numbers, Quaternion, Skipped, Status, Text};

/// Messages with a header, by their types without `msg/`. Covariances are row by row.
const TYPES: [(&str, &[Part]); 8] = [
    (
        "sensor_msgs/Imu",
        &[
            Quaternion("orientation"),
            Skipped(9),
            Numbers("angular_velocity", 3),
            Skipped(9),
            Numbers("linear_acceleration", 3),
        ],
    ),
    ("geometry_msgs/PoseStamped", &[Numbers("position", 3), Quaternion("orientation")]),
    ("geometry_msgs/PoseWithCovarianceStamped", &[Numbers("position", 3), Quaternion("orientation")]),
    ("geometry_msgs/TransformStamped", &[Text, Numbers("translation", 3), Quaternion("rotation")]),
    ("geometry_msgs/TwistStamped", &[Numbers("linear", 3), Numbers("angular", 3)]),
    (
        "nav_msgs/Odometry",
        &[
            Text,
            Numbers("position", 3),
            Quaternion("orientation"),
            Skipped(36),
            Numbers("linear", 3),
            Numbers("angular", 3),
        ],
    ),
    (
        "sensor_msgs/NavSatFix",
        &[Status("status"), Numbers("latitude", 1), Numbers("longitude", 1), Numbers("altitude", 1)],
    ),
    ("sensor_msgs/Temperature", &[Numbers("temperature", 1)]),
];

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    /// One after the other.
    Ros1,
    /// Each at a multiple of its size, after four bytes that say so.
    #[cfg_attr(not(feature = "mcap"), allow(dead_code, reason = "ROS 2 records MCAP"))]
    Cdr,
}

/// A topic whose messages are read.
pub(super) struct Topic {
    parts: &'static [Part],
    encoding: Encoding,
    /// Place of its first field.
    first: usize,
}

impl Topic {
    /// Of a type that is known; nothing of any other.
    pub(super) fn new(
        topics: &mut Topics,
        name: &str,
        kind: &str,
        encoding: Encoding,
    ) -> Result<Option<Self>, String> {
        let kind = kind.replace("/msg/", "/");
        let Some((_, parts)) = TYPES.iter().find(|(known, _)| *known == kind) else { return Ok(None) };
        let first = topics.declare(name, "stamp.secs", 1)?;
        topics.declare(name, "stamp.nsecs", 1)?;
        for part in *parts {
            match *part {
                Numbers(field, width) => topics.declare(name, field, width).map(drop)?,
                Quaternion(field) => topics.declare(name, field, 4).map(drop)?,
                Status(field) => topics.declare(name, field, 1).map(drop)?,
                Skipped(_) | Text => {}
            }
        }
        Ok(Some(Self { parts, encoding, first }))
    }

    /// Reads a message.
    pub(super) fn read(&self, topics: &mut Topics, message: &[u8]) -> Result<(), String> {
        self.walk(message, &mut |place, numbers, _| topics.push(place, numbers))
    }

    /// Writes what will be into a message.
    pub(super) fn write(&self, rewriting: &mut Rewriting<'_>, message: &mut [u8]) -> Result<(), String> {
        let mut written = Vec::new();
        self.walk(message, &mut |place, _, at| {
            if let Some(numbers) = rewriting.next(place)? {
                let at = at.ok_or("what changes in it are no plain numbers")?;
                written.push((at, numbers.iter().flat_map(|number| number.to_le_bytes()).collect()));
            }
            Ok(())
        })?;
        for (at, bytes) in written {
            let bytes: Vec<u8> = bytes;
            message[at..at + bytes.len()].copy_from_slice(&bytes);
        }
        Ok(())
    }

    /// Hands over the fields of a message: place, numbers, and where these stand if as they are.
    fn walk(&self, message: &[u8], each: Each<'_>) -> Result<(), String> {
        let mut cursor = Cursor::new(message, self.encoding)?;
        if self.encoding == Encoding::Ros1 {
            // the number of the message
            cursor.integer()?;
        }
        let (secs, nanos) = (cursor.integer()?, cursor.integer()?);
        cursor.text()?;
        each(self.first, &[secs.into()], None)?;
        each(self.first + 1, &[nanos.into()], None)?;
        let mut place = self.first + 2;
        for part in self.parts {
            let mut at = None;
            let numbers = match *part {
                Numbers(_, width) => {
                    let numbers = cursor.numbers(width)?;
                    at = Some(cursor.passed() - width * size_of::<f64>());
                    numbers
                }
                Quaternion(_) => {
                    let mut numbers = cursor.numbers(4)?;
                    numbers.rotate_right(1);
                    numbers
                }
                Status(_) => vec![cursor.status()?],
                Skipped(count) => {
                    cursor.numbers(count)?;
                    continue;
                }
                Text => {
                    cursor.text()?;
                    continue;
                }
            };
            each(place, &numbers, at)?;
            place += 1;
        }
        Ok(())
    }
}

/// Is handed a field.
type Each<'a> = &'a mut dyn FnMut(usize, &[f64], Option<usize>) -> Result<(), String>;

/// What says how a message is written in CDR, bytes.
const CDR_HEAD: usize = 4;

/// Where reading a message stands.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    aligned: bool,
}

impl<'a> Cursor<'a> {
    fn new(message: &'a [u8], encoding: Encoding) -> Result<Self, String> {
        match encoding {
            Encoding::Ros1 => Ok(Self { bytes: message, at: 0, aligned: false }),
            Encoding::Cdr => match message {
                [0, 1, _, _, rest @ ..] => Ok(Self { bytes: rest, at: 0, aligned: true }),
                _ => Err("a message is not written in little-endian CDR".into()),
            },
        }
    }

    /// Bytes of the message up to here.
    fn passed(&self) -> usize {
        self.at + if self.aligned { CDR_HEAD } else { 0 }
    }

    fn take<const N: usize>(&mut self, align: usize) -> Result<[u8; N], String> {
        if self.aligned {
            self.at = self.at.next_multiple_of(align);
        }
        let bytes = self.bytes.get(self.at..).and_then(<[u8]>::first_chunk::<N>);
        self.at += N;
        bytes.copied().ok_or_else(|| "a message is shorter than its type".into())
    }

    fn integer(&mut self) -> Result<u32, String> {
        self.take(4).map(u32::from_le_bytes)
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f64>, String> {
        (0..count).map(|_| self.take(8).map(f64::from_le_bytes)).collect()
    }

    fn status(&mut self) -> Result<f64, String> {
        let [status] = self.take::<1>(1)?;
        self.take::<2>(2)?;
        Ok(status.cast_signed().into())
    }

    fn text(&mut self) -> Result<(), String> {
        let length = self.integer()? as usize;
        self.at = self.at.saturating_add(length).min(self.bytes.len() + 1);
        Ok(())
    }
}
