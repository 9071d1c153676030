//! A campaign's folder: one file per finished unit, written whole or not at all, and the plan they all belong to.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Result, miette};
use serde::{Deserialize, Serialize};
use study::{Plan, UnitResult};

use crate::output::{self, Files};

/// What must be the same for results to belong together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Identity {
    program: String,
    pub(super) filters: Vec<String>,
    passes: u32,
    hours: f64,
    alignment_s: f64,
    scenario: String,
    swing: String,
}

impl Identity {
    pub(super) fn of(plan: &Plan) -> Self {
        Self {
            program: concat!("sinscal ", env!("CARGO_PKG_VERSION")).to_owned(),
            filters: plan.filters.iter().map(|filter| filter.title()).collect(),
            passes: plan.passes,
            hours: plan.hours,
            alignment_s: plan.alignment,
            scenario: format!("{:?}", plan.scenario),
            swing: format!("{:?}", plan.motion),
        }
    }

    /// Name of the first field in which two plans differ.
    pub(super) fn difference(&self, other: &Self) -> Option<&'static str> {
        let differs = [
            ("program", self.program != other.program),
            ("filters", self.filters != other.filters),
            ("passes", self.passes != other.passes),
            ("hours", self.hours != other.hours),
            ("alignment_s", self.alignment_s != other.alignment_s),
            ("scenario", self.scenario != other.scenario),
            ("swing", self.swing != other.swing),
        ];
        differs.into_iter().find(|(_, differs)| *differs).map(|(name, _)| name)
    }
}

/// The folder.
pub(super) struct Store {
    folder: PathBuf,
    /// Keeps others out as long as the program lives; the system takes it from a program that is killed.
    lock: Option<File>,
}

impl Store {
    /// Opens a folder for results of `plan`, made where missing. Several shards may work in it at once, but not two
    /// whole campaigns.
    pub(super) fn create(folder: &Path, identity: &Identity, shard: bool) -> Result<Self> {
        let mut store = Self { folder: folder.to_owned(), lock: None };
        let path = store.plan_path();
        if !path.exists() {
            let text = serde_json::to_string_pretty(identity).into_diagnostic()? + "\n";
            let mut files = Files::default();
            files.folder(&store.units())?;
            files.write(&path, |file| file.write_all(text.as_bytes()))?;
            files.commit_new()?;
        }
        let found = store.identity()?;
        if let Some(field) = identity.difference(&found) {
            return Err(miette!(
                help = "name another folder with --out, or delete this one",
                "{}, field `{field}`: the units in this folder were put through another campaign",
                path.display()
            ));
        }
        let plan =
            File::open(&path).map_err(|error| miette!("{}: cannot be read: {error}", path.display()))?;
        let locked = if shard { plan.try_lock_shared() } else { plan.try_lock() };
        if let Err(TryLockError::WouldBlock) = locked {
            return Err(miette!(
                help = "let it end, name another folder with --out, or share the units out with --shard",
                "{}: another campaign is at work in this folder",
                folder.display()
            ));
        }
        store.lock = Some(plan);
        output::sweep(&store.folder);
        output::sweep(&store.units());
        Ok(store)
    }

    /// Opens a folder that holds results.
    pub(super) fn open(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), lock: None }
    }

    /// What the results in the folder belong to.
    pub(super) fn identity(&self) -> Result<Identity> {
        let path = self.plan_path();
        let text = fs::read_to_string(&path).map_err(|error| {
            miette!("{}: cannot be read: {error}; is this a campaign's folder?", path.display())
        })?;
        serde_json::from_str(&text).map_err(|error| miette!("{}: {error}", path.display()))
    }

    pub(super) fn plan_path(&self) -> PathBuf {
        self.folder.join("plan.json")
    }

    fn units(&self) -> PathBuf {
        self.folder.join("units")
    }

    pub(super) fn unit_path(&self, unit: u64) -> PathBuf {
        self.units().join(format!("unit-{unit:06}.json"))
    }

    /// The result of a unit, if it is there and whole.
    pub(super) fn unit(&self, unit: u64) -> Option<UnitResult> {
        let text = fs::read_to_string(self.unit_path(unit)).ok()?;
        serde_json::from_str::<UnitResult>(&text).ok().filter(|result| result.unit == unit)
    }

    /// Numbers of the units in the folder.
    pub(super) fn finished(&self) -> Result<Vec<u64>> {
        let folder = self.units();
        let entries = fs::read_dir(&folder)
            .map_err(|error| miette!("{}: cannot be read: {error}", folder.display()))?;
        let mut units: Vec<u64> = entries
            .filter_map(|entry| {
                let name = entry.ok()?.file_name().into_string().ok()?;
                name.strip_prefix("unit-")?.strip_suffix(".json")?.parse().ok()
            })
            .collect();
        units.sort_unstable();
        Ok(units)
    }

    /// Keeps a result.
    pub(super) fn keep(&self, result: &UnitResult) -> Result<()> {
        let text = serde_json::to_string(result).into_diagnostic()? + "\n";
        let mut files = Files::default();
        files.write(&self.unit_path(result.unit), |file| file.write_all(text.as_bytes()))?;
        files.commit()
    }
}
