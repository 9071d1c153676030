//! HDF5 files: `.h5`, and MATLAB's `save -v7.3`. Datasets in groups go by their path, `imu/gyro`.

use std::ops::Range;
use std::path::Path;

use hdf5_reader::group::Group;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::layout::DataLayout;
use hdf5_reader::{ByteOrder, Dataset, Datatype, H5Type, Hdf5File, OpenOptions, SliceInfo, SliceInfoElem};

use super::arrays::{Arrays, LARGEST, MOST_VARIABLES, Named};
use super::fault::LogError;
use super::guard::guarded;
use super::rewrite::arrays::{Changes, whole};

/// Deflate packs no tighter: what announces more numbers than that is damaged.
const TIGHTEST: u64 = 1100;
/// Numbers read at a time, beside the columns that they go to.
const PIECE: u64 = 1 << 20;
/// Groups are not nested deeper.
const DEEPEST: usize = 8;

/// An HDF5 file, its datasets listed.
pub(super) struct Hdf5 {
    datasets: Vec<Option<Dataset>>,
}

impl Hdf5 {
    /// Opens a file and lists its datasets.
    pub(super) fn open(path: &Path) -> Result<(Self, Vec<Named>), LogError> {
        let length = std::fs::metadata(path).map_err(|error| super::unreadable(path, &error))?.len();
        let mut found = Vec::new();
        guarded(|| {
            let file = file(path)?;
            let root = file.root_group().map_err(|error| error.to_string())?;
            list(&root, "", 0, length.saturating_mul(TIGHTEST), &mut found)
        })
        .map_err(|problem| {
            let known = "h5py, and MATLAB with `save -v7.3`, write what is read here";
            if is_foreign(&problem) {
                return LogError::file(path, format!("holds what is not read here: {problem}")).help(
                    format!("virtual datasets and the like are to be copied into plain ones; {known}"),
                );
            }
            LogError::file(path, format!("is not an HDF5 file, damaged or cut off: {problem}")).help(known)
        })?;
        let (named, datasets) = found.into_iter().unzip();
        Ok((Self { datasets }, named))
    }
}

impl Arrays for Hdf5 {
    fn read(&mut self, index: usize, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
        let dataset = self.datasets.get(index).and_then(Option::as_ref).ok_or("it is not there")?;
        guarded(|| numbers(dataset, each))
    }
}

fn file(path: &Path) -> Result<Hdf5File, String> {
    let options = OpenOptions::default().with_max_read_bytes(LARGEST as usize);
    Hdf5File::open_with_options(path, options).map_err(|error| error.to_string())
}

/// The bytes of a file with other numbers in some of its datasets. Everything else stays as it is.
pub(super) fn rewritten(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let mut bytes = whole(path)?;
    let opened = file(path)?;
    let (mut hdf5, named) = Hdf5::open(path).map_err(|fault| fault.to_string())?;
    for (index, named) in named.iter().enumerate().filter(|(index, _)| changes.has(*index)) {
        let dims = named.dims.clone()?;
        let mut numbers = Vec::new();
        hdf5.read(index, &mut |number| {
            numbers.push(number);
            true
        })?;
        changes.apply(index, &dims, &mut numbers)?;
        let dataset = hdf5.datasets[index].as_ref().ok_or("it is not there")?;
        let place = place(&opened, dataset)?.and_then(|place| bytes.get_mut(place));
        let place = place.ok_or_else(|| {
            format!(
                "{} stands in pieces, or packed: only datasets in one piece are written (h5py's, without chunks and compression)",
                named.name
            )
        })?;
        put(place, dataset.dtype(), &numbers).map_err(|problem| format!("{}: {problem}", named.name))?;
    }
    Ok(bytes)
}

/// Where the numbers of a dataset stand in the file, if in one piece.
fn place(file: &Hdf5File, dataset: &Dataset) -> Result<Option<Range<usize>>, String> {
    let header = file.get_or_parse_header(dataset.address()).map_err(|error| error.to_string())?;
    let layout = header.messages.iter().find_map(|message| match message {
        HdfMessage::DataLayout(message) => Some(&message.layout),
        _ => None,
    });
    Ok(layout.and_then(|layout| match layout {
        DataLayout::Contiguous { address, size } => {
            let first = usize::try_from(file.superblock().base_address.checked_add(*address)?).ok()?;
            Some(first..first.checked_add(usize::try_from(*size).ok()?)?)
        }
        _ => None,
    }))
}

/// Writes the numbers of a dataset.
fn put(place: &mut [u8], datatype: &Datatype, numbers: &[f64]) -> Result<(), &'static str> {
    let Datatype::FloatingPoint { size, byte_order } = datatype else {
        return Err("its numbers are whole: what is taken out of them does not fit in");
    };
    let size = usize::from(*size);
    if place.len() != numbers.len() * size {
        return Err("the log has changed meanwhile");
    }
    for (place, number) in place.chunks_exact_mut(size).zip(numbers) {
        let big = *byte_order == ByteOrder::BigEndian;
        match (size, big) {
            (8, false) => place.copy_from_slice(&number.to_le_bytes()),
            (8, true) => place.copy_from_slice(&number.to_be_bytes()),
            (4, false) => place.copy_from_slice(&(*number as f32).to_le_bytes()),
            (4, true) => place.copy_from_slice(&(*number as f32).to_be_bytes()),
            _ => return Err("its numbers are of an unusual size"),
        }
    }
    Ok(())
}

/// A number of whatever type the file has. One type, so that what reads a dataset is compiled once and not for each of ten.
#[derive(Clone, Copy)]
struct Number(f64);

/// `with_kind!(datatype, Kind => of_kind, unknown)`: evaluates `of_kind` with `Kind` the type of number that a file means.
macro_rules! with_kind {
    ($datatype:expr, $kind:ident => $call:expr, $unknown:expr) => {{
        macro_rules! of {
            ($number:ty) => {{
                type $kind = $number;
                $call
            }};
        }
        match $datatype {
            Datatype::FloatingPoint { size: 8, .. } => of!(f64),
            Datatype::FloatingPoint { size: 4, .. } => of!(f32),
            Datatype::FixedPoint { size: 8, signed: true, .. } => of!(i64),
            Datatype::FixedPoint { size: 4, signed: true, .. } => of!(i32),
            Datatype::FixedPoint { size: 2, signed: true, .. } => of!(i16),
            Datatype::FixedPoint { size: 1, signed: true, .. } => of!(i8),
            Datatype::FixedPoint { size: 8, .. } => of!(u64),
            Datatype::FixedPoint { size: 4, .. } => of!(u32),
            Datatype::FixedPoint { size: 2, .. } => of!(u16),
            Datatype::FixedPoint { size: 1, .. } => of!(u8),
            _ => $unknown,
        }
    }};
}

impl H5Type for Number {
    fn hdf5_type() -> Datatype {
        f64::hdf5_type()
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> Result<Self, hdf5_reader::error::Error> {
        let number = with_kind!(
            datatype,
            Kind => Kind::from_bytes(bytes, datatype)? as f64,
            // which says what it is
            f64::from_bytes(bytes, datatype)?
        );
        Ok(Self(number))
    }

    fn element_size(datatype: &Datatype) -> usize {
        with_kind!(datatype, Kind => Kind::element_size(datatype), size_of::<f64>())
    }

    fn decode_vec(
        raw: &[u8],
        datatype: &Datatype,
        count: usize,
    ) -> Option<Result<Vec<Self>, hdf5_reader::error::Error>> {
        with_kind!(
            datatype,
            Kind => {
                let decoded = Kind::decode_vec(raw, datatype, count)?;
                Some(decoded.map(|numbers| numbers.into_iter().map(|number| Self(number as f64)).collect()))
            },
            None
        )
    }
}

/// Whether something is sound but of a kind that is not read here.
fn is_foreign(problem: &str) -> bool {
    let problem = problem.to_ascii_lowercase();
    ["unsupported", "not supported", "unknown filter"].iter().any(|words| problem.contains(words))
}

/// Hands over the numbers of a dataset, piece by piece along its slowest side.
fn numbers(dataset: &Dataset, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
    if with_kind!(dataset.dtype(), Kind => size_of::<Kind>(), 0) == 0 {
        return Err("it holds no plain numbers".into());
    }
    let Some((rows, inner)) = dataset.shape().split_first() else {
        let array = dataset.read_array::<Number>().map_err(|error| error.to_string())?;
        let _ = array.into_iter().all(|number| each(number.0));
        return Ok(());
    };
    let width = inner.iter().product::<u64>().max(1);
    let mut step = (PIECE / width).max(1);
    // Chunks are unpacked whole: each once, unless they are large.
    if let Some(chunk) = dataset.chunks().and_then(|chunks| chunks.first().map(|rows| u64::from(*rows))) {
        let whole = step.next_multiple_of(chunk.max(1));
        if whole.saturating_mul(width) <= 4 * PIECE {
            step = whole;
        }
    }
    let all = |side: &u64| SliceInfoElem::Slice { start: 0, end: *side, step: 1 };
    let mut start = 0;
    while start < *rows {
        let end = rows.min(&start.saturating_add(step)).to_owned();
        let mut selections = vec![SliceInfoElem::Slice { start, end, step: 1 }];
        selections.extend(inner.iter().map(all));
        let slice = SliceInfo { selections };
        let array = dataset.read_slice::<Number>(&slice).map_err(|error| error.to_string())?;
        if !array.into_iter().all(|number| each(number.0)) {
            break;
        }
        start = end;
    }
    Ok(())
}

/// Lists the datasets of a group and those below it.
fn list(
    group: &Group,
    prefix: &str,
    depth: usize,
    most: u64,
    found: &mut Vec<(Named, Option<Dataset>)>,
) -> Result<(), String> {
    let (groups, datasets) = group.members().map_err(|error| error.to_string())?;
    if found.len() + datasets.len() + groups.len() > MOST_VARIABLES || depth > DEEPEST {
        return Err(format!("it holds more than {MOST_VARIABLES} datasets, or groups deeper than {DEEPEST}"));
    }
    for dataset in datasets {
        let name = format!("{prefix}{}", dataset.name());
        found.push((Named { name, dims: describe(&dataset, most) }, Some(dataset)));
    }
    for group in groups {
        // what MATLAB keeps for itself
        if group.name().starts_with('#') {
            continue;
        }
        let name = format!("{prefix}{}", group.name());
        let sparse = group.attribute("MATLAB_sparse").is_ok();
        if sparse {
            found.push((Named { name, dims: Err("a sparse matrix".into()) }, None));
        } else {
            list(&group, &format!("{name}/"), depth + 1, most, found)?;
        }
    }
    Ok(())
}

/// The dimensions of a dataset, or what it holds instead of numbers, at most `most` bytes.
fn describe(dataset: &Dataset, most: u64) -> Result<Vec<u64>, String> {
    let class = dataset.attribute("MATLAB_class").and_then(|class| class.read_string()).unwrap_or_default();
    let holds = match (class.trim_end_matches('\0'), dataset.dtype()) {
        ("char" | "string", _) | (_, Datatype::String { .. } | Datatype::VarLen { .. }) => "text",
        ("cell", _) => "cells",
        ("struct", _) => "a struct",
        ("logical", _) | (_, Datatype::Enum { .. }) => "true/false values",
        _ if dataset.attribute("MATLAB_empty").is_ok() => "nothing (it is empty)",
        (_, Datatype::Compound { fields, .. }) => match fields.len() {
            2 => "complex values",
            _ => "a table of named fields: save each field as a dataset",
        },
        (
            _,
            Datatype::FloatingPoint { size: 4 | 8, .. } | Datatype::FixedPoint { size: 1 | 2 | 4 | 8, .. },
        ) => {
            let size = dataset.num_elements().map_err(|error| error.to_string())?;
            if size > most {
                return Err(format!("{size} numbers, it says, more than there can be in the file"));
            }
            return Ok(dataset.shape().to_vec());
        }
        (_, Datatype::FloatingPoint { .. } | Datatype::FixedPoint { .. }) => {
            "numbers of an unusual size, such as float16: save them as float32 or float64"
        }
        _ => "no numbers",
    };
    Err(holds.into())
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::rewrite::arrays::{change, changed};
    use crate::tests::support::Done;

    const ROWS: usize = 30;

    /// Files that h5py wrote.
    fn fixture(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../cli/tests/formats").join(name)
    }

    /// Names and numbers of the datasets that hold some.
    fn arrays(path: &Path) -> Result<Vec<(usize, String, Vec<f64>)>, LogError> {
        let (mut hdf5, named) = Hdf5::open(path)?;
        let numbers = |(index, named): (usize, Named)| {
            let mut numbers = Vec::new();
            named.dims.ok()?;
            let each = &mut |number| {
                numbers.push(number);
                true
            };
            hdf5.read(index, each).ok()?;
            Some((index, named.name, numbers))
        };
        Ok(named.into_iter().enumerate().filter_map(numbers).collect())
    }

    #[test]
    fn datasets_in_one_piece_change_and_nothing_else() -> Done {
        let folder = tempfile::tempdir()?;
        let (path, copy) = (fixture("workspace.h5"), folder.path().join("copy.h5"));
        let mut expected = arrays(&path)?;
        let place =
            |name: &str| expected.iter().position(|(_, known, _)| known == name).ok_or("no such dataset");
        let (rates, forces) = (place("wm")?, place("vm")?);
        let (wm, vm) = (expected[rates].0, expected[forces].0);
        for row in 0..ROWS {
            // 3 x 30 and 30 x 3
            expected[rates].2[ROWS + row] += change(wm, 1, row);
            expected[forces].2[3 * row + 2] += change(vm, 2, row);
        }
        let written = changed(&path, rewritten, ROWS, &[(wm, 1), (vm, 2)])?;
        std::fs::write(&copy, &written)?;
        assert_eq!(arrays(&copy)?, expected);
        let before = std::fs::read(&path)?;
        let others = before.iter().zip(&written).filter(|(old, new)| old != new).count();
        assert!(written.len() == before.len() && others <= 2 * ROWS * size_of::<f64>(), "{others}");
        Ok(())
    }

    #[test]
    fn what_stands_in_pieces_or_holds_whole_numbers_is_not_written() -> Done {
        let packed =
            changed(&fixture("small-packed.h5"), rewritten, ROWS, &[(0, 1)]).err().ok_or("written")?;
        assert!(packed.to_string().contains("imu stands in pieces, or packed"), "{packed}");
        let path = fixture("workspace.h5");
        let counts = arrays(&path)?.into_iter().find(|(_, name, _)| name == "count").ok_or("no counts")?;
        let whole = changed(&path, rewritten, ROWS, &[(counts.0, 0)]).err().ok_or("written")?;
        assert!(whole.to_string().contains("count: its numbers are whole"), "{whole}");
        Ok(())
    }
}
