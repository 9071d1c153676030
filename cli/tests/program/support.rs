//! Small logs for tests, as CSV and as Parquet.

use std::error::Error;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;

/// What a test returns.
pub(crate) type Done = Result<(), Box<dyn Error>>;

/// Sampling rate of the tables, Hz.
pub(crate) const RATE: f64 = 50.0;

/// A sound description for a table of this module.
pub(crate) const DESCRIPTION: &str = r#"# A unit at rest
[imu]
rate_hz = 50.0
[site]
latitude_deg = 32.06
longitude_deg = 118.8
height_m = 20.0
[initial]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
level_sigma_deg = 0.05
heading_sigma_deg = 0.2
[reference]
velocity_sigma_m_s = 0.001
position_sigma_m = 0.002
attitude_sigma_deg = 0.01
[noise]
gyro_arw_deg_sqrt_h = 0.001
accel_vrw_ug_sqrt_hz = 5.0
[temperature]
reference_c = 25.0
[outer_lever]
xyz_m = [0.0, 0.0, 0.0]
[prior]
"accel-bias" = { sigma = 300.0, unit = "ug" }
"#;

/// A table in memory.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) columns: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// A unit at rest with level x and y axes, x pointing east, with every optional column.
    pub(crate) fn at_rest(rows: usize) -> Self {
        let latitude = 32.06_f64.to_radians();
        let (earth, gravity) = (7.292_115e-5 / RATE, 9.794_6 / RATE);
        let constants = [
            ("dtheta_x", 0.0),
            ("dtheta_y", earth * latitude.cos()),
            ("dtheta_z", earth * latitude.sin()),
            ("dvel_x", 0.0),
            ("dvel_y", 0.0),
            ("dvel_z", gravity),
            ("temp_x", 30.0),
            ("temp_y", 30.5),
            ("temp_z", 31.0),
            ("temp_gyro_x", 29.0),
            ("temp_gyro_y", 29.5),
            ("temp_gyro_z", 28.0),
            ("dither_x", 0.07),
            ("dither_y", 0.08),
            ("dither_z", 0.09),
            ("ref_vel_e", 0.0),
            ("ref_vel_n", 0.0),
            ("ref_vel_u", 0.0),
            ("ref_pos_e", 0.0),
            ("ref_pos_n", 0.0),
            ("ref_pos_u", 0.0),
            ("ref_quat_w", 1.0),
            ("ref_quat_x", 0.0),
            ("ref_quat_y", 0.0),
            ("ref_quat_z", 0.0),
        ];
        let time = (1..=rows).map(|row| row as f64 / RATE).collect();
        let mut columns = vec![("time_s".to_owned(), time)];
        columns.extend(constants.map(|(name, value)| (name.to_owned(), vec![value; rows])));
        Self { columns }
    }

    /// Puts a value into a data row counted from 1; a name with a star stands for all columns that begin so.
    pub(crate) fn set(&mut self, column: &str, row: usize, value: f64) {
        for (_, values) in self.matching(column) {
            values[row - 1] = value;
        }
    }

    /// Changes every value of a column.
    pub(crate) fn map(&mut self, column: &str, change: impl Fn(usize, f64) -> f64) {
        for (_, values) in self.matching(column) {
            for (index, value) in values.iter_mut().enumerate() {
                *value = change(index + 1, *value);
            }
        }
    }

    /// Takes columns out.
    pub(crate) fn drop(&mut self, column: &str) {
        self.columns.retain(|(name, _)| !matches(name, column));
    }

    /// Takes out rows counted from 1.
    pub(crate) fn drop_rows(&mut self, rows: std::ops::RangeInclusive<usize>) {
        for (_, values) in &mut self.columns {
            values.drain(rows.start() - 1..*rows.end());
        }
    }

    /// Calls a column by another name.
    pub(crate) fn rename(&mut self, from: &str, to: &str) {
        for (name, _) in self.matching(from) {
            to.clone_into(name);
        }
    }

    fn matching<'a>(&'a mut self, column: &'a str) -> impl Iterator<Item = &'a mut (String, Vec<f64>)> {
        self.columns.iter_mut().filter(move |(name, _)| matches(name, column))
    }

    /// As comma-separated text; NaN is an empty field where that is allowed.
    pub(crate) fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
        let mut text = names.join(",") + "\n";
        let rows = self.columns.first().map_or(0, |(_, values)| values.len());
        for row in 0..rows {
            let fields = self.columns.iter().map(|(name, values)| {
                let required = name == "time_s" || name.starts_with('d') && !name.starts_with("dither");
                if values[row].is_nan() && !required { String::new() } else { values[row].to_string() }
            });
            text += &fields.collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        text
    }

    /// Writes a Parquet file; the column called `text`, if any, holds text instead of numbers.
    pub(crate) fn write_parquet(&self, path: &Path, text: Option<&str>) -> Done {
        let arrays = self.columns.iter().map(|(name, values)| {
            let array: ArrayRef = if text == Some(name) {
                Arc::new(StringArray::from_iter_values(values.iter().map(f64::to_string)))
            } else {
                Arc::new(Float64Array::from(values.clone()))
            };
            (name.clone(), array)
        });
        let batch = RecordBatch::try_from_iter(arrays)?;
        let mut writer = ArrowWriter::try_new(File::create(path)?, batch.schema(), None)?;
        writer.write(&batch)?;
        writer.close()?;
        Ok(())
    }

    /// Writes `NAME.csv`.
    pub(crate) fn write_csv(&self, path: &Path) -> Done {
        Ok(fs::write(path, self.csv())?)
    }
}

fn matches(name: &str, pattern: &str) -> bool {
    pattern.strip_suffix('*').map_or(name == pattern, |start| name.starts_with(start))
}
