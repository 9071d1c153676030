//! The open stage: is something there that no effect of the library explains?

use crate::dictionary::{Dictionary, Triad};
use crate::error::SceneError;
use crate::linear::run;
use crate::name::MARGIN;
use crate::prices::{Group, Prices, Score, groups_of};
use crate::recording::Recording;
use crate::scan::{CELLS, Scan, Stretch, cells};
use crate::scene::Scene;
use crate::threshold;
use crate::verify::WIDENED;

/// Name of the family of all steps.
const RANDOM_WALK: &str = "random walk of the bias";
/// A walk is one bias in each of so many parts of the log.
const PARTS: usize = 8;

/// A named effect must keep this part of its gain when a family joins...
const KEPT: f64 = 0.5;
/// ...or keep so many times what the family adds.
const FAR_MORE: f64 = 100.0;

/// A stretch of the log in which the bias of a triad is another.
#[derive(Clone, Debug)]
pub(crate) struct Burst {
    pub(crate) stretch: Stretch,
    pub(crate) triad: Triad,
    /// Logarithm of the number of stretches it was chosen from.
    ln_chosen_from: f64,
}

/// Families, bursts and library priced together.
pub(crate) struct Open {
    pub(crate) prices: Prices,
    /// Columns of the [`vocabulary`] that each priced column is the sum of.
    pub(crate) columns: Vec<Vec<usize>>,
    /// Groups of families come first; there are this many, the bursts included.
    pub(crate) families: usize,
    /// The last of the families: the most significant stretches.
    bursts: Vec<Burst>,
    pub(crate) units: Vec<String>,
    /// What a family must fall below on its own.
    pub(crate) threshold: f64,
    /// What a burst must fall below.
    pub(crate) threshold_of_bursts: f64,
    rms: Vec<f64>,
    updates: usize,
}

/// The families of every triad, then the cells of every triad, then `library`.
pub(crate) fn vocabulary<'a>(recording: &Recording, library: &'a [usize]) -> Dictionary<'a> {
    let triads = Triad::all(recording);
    let mut dictionary = Dictionary::new(library);
    for triad in &triads {
        dictionary.add_families(recording, triad);
    }
    for triad in &triads {
        dictionary.add_cells(recording, triad, &cells(recording.span()));
    }
    dictionary
}

impl Open {
    /// From prices whose first `families` groups are families, the others the library's; `rms` of each column.
    #[cfg(test)]
    pub(crate) fn of_prices(
        prices: Prices,
        families: usize,
        threshold: f64,
        rms: Vec<f64>,
        updates: usize,
    ) -> Self {
        Self {
            columns: (0..rms.len()).map(|c| vec![c]).collect(),
            units: vec!["1".into(); families],
            prices,
            families,
            bursts: Vec::new(),
            threshold,
            threshold_of_bursts: threshold,
            rms,
            updates,
        }
    }

    /// With the thresholds that are exceeded with probability `rate` when nothing is missing.
    pub(crate) fn new(scene: &Scene, rate: f64, seed: u64) -> Result<Option<Self>, SceneError> {
        let Some((mut new, of_cells)) = Self::priced(scene)? else { return Ok(None) };
        let own: Vec<usize> = (0..new.families - new.bursts.len()).collect();
        new.threshold = threshold::simulate(&new.prices, &own, rate / 2.0, seed, "dictionary");
        let scans: Vec<(usize, Scan)> = (0..of_cells.groups.len())
            .map(|triad| (3 * CELLS * triad, Scan::new(&of_cells.only(&[triad]).lambda, 1)))
            .collect();
        let least = |b: &[f64]| {
            let most = |(at, scan): &(usize, Scan)| scan.most(&b[*at..*at + 3 * CELLS]).map_or(0.0, |m| m.1);
            scans.iter().map(most).fold(0.0, f64::min)
        };
        new.threshold_of_bursts = threshold::least(&of_cells.lambda, rate / 2.0, seed, "bursts", &least);
        for i in 0..new.bursts.len() {
            let g = new.families - new.bursts.len() + i;
            if new.prices.score(g).ln_p < new.threshold_of_bursts {
                let burst = &mut new.bursts[i];
                if let Some(stretch) = finer(scene, burst)? {
                    burst.stretch = stretch;
                    new.prices.groups[g].name = stretch.name(burst.triad.name);
                }
            }
        }
        Ok(Some(new))
    }

    /// Without thresholds.
    pub(crate) fn prices(scene: &Scene) -> Result<Option<Self>, SceneError> {
        Ok(Self::priced(scene)?.map(|priced| priced.0))
    }

    /// Without thresholds, and what the cells of each triad say. Nothing where no signal was recorded that makes a family.
    fn priced(scene: &Scene) -> Result<Option<(Self, Prices)>, SceneError> {
        let recording = &scene.ran.recording;
        let library = recording.candidates();
        let triads = Triad::all(recording);
        let dictionary = vocabulary(recording, &library);
        if dictionary.own() == 0 {
            return Ok(None);
        }
        let features = dictionary.own() - 3 * CELLS * triads.len();
        let found = run(recording, &recording.base(), &dictionary, &scene.noise, &mut |_| {})
            .ok_or(SceneError::Indefinite)?;
        let mut sigma = dictionary.sigma.clone();
        sigma.extend(library.iter().map(|c| recording.columns[*c].prior));
        let mut known = groups_of(&recording.columns, &library);
        for m in known.iter_mut().flat_map(|g| &mut g.members) {
            *m += dictionary.own();
        }
        let of_triad = |i: usize| {
            let first = features + 3 * CELLS * i;
            Group { name: triads[i].name.into(), members: (first..first + 3 * CELLS).collect() }
        };
        let mut all: Vec<Group> = (0..triads.len()).map(of_triad).collect();
        all.extend(known.iter().cloned());
        let all = Prices::new(&found.gram, sigma, all);
        let own: Vec<usize> = (0..triads.len()).collect();

        // columns and groups in their order here: features, walks, bursts, library
        let mut sums: Vec<Vec<usize>> = (0..features).map(|c| vec![c]).collect();
        let mut groups = dictionary.groups.clone();
        let mut units = dictionary.units.clone();
        let mut add = |triad: usize, name: String, parts: &[(usize, usize)]| {
            let first = sums.len();
            let column = |cell: usize, axis: usize| features + 3 * (CELLS * triad + cell) + axis;
            for part in parts {
                sums.extend((0..3).map(|axis| (part.0..part.1).map(|cell| column(cell, axis)).collect()));
            }
            groups.push(Group { name, members: (first..sums.len()).collect() });
            units.push(recording.columns[triads[triad].columns[0]].info.unit.into());
        };
        let parts: Vec<(usize, usize)> =
            (0..PARTS).map(|i| (i * CELLS / PARTS, (i + 1) * CELLS / PARTS)).collect();
        for (i, triad) in triads.iter().enumerate() {
            add(i, format!("{RANDOM_WALK} in the {}s", triad.name), &parts);
        }
        let bounds = cells(recording.span());
        let mut bursts = Vec::new();
        // the most significant stretch as it is, and the one on top of all that is known
        let everything: Vec<usize> = (triads.len()..all.groups.len()).collect();
        for prices in [Some(all.clone()), all.given(&everything)].into_iter().flatten() {
            for (i, triad) in triads.iter().enumerate() {
                let here = prices.only(&[i]);
                let scan = Scan::new(&here.lambda, 1);
                let Some(((from, to), _)) = scan.most(here.b.as_slice()) else { continue };
                let stretch = Stretch { start: bounds[from], end: bounds[to], lasts: to == CELLS };
                let is_new = |b: &Burst| b.triad.name != triad.name || b.stretch != stretch;
                if bursts.iter().all(is_new) {
                    add(i, stretch.name(triad.name), &[(from, to)]);
                    let ln_chosen_from = (scan.count() as f64).ln();
                    bursts.push(Burst { stretch, triad: *triad, ln_chosen_from });
                }
            }
        }
        let families = groups.len();
        for group in &known {
            let first = sums.len();
            sums.extend(group.members.iter().map(|m| vec![*m]));
            groups.push(Group { name: group.name.clone(), members: (first..sums.len()).collect() });
        }
        let mut rms = dictionary.rms[..features].to_vec();
        rms.resize(sums.len(), 1.0);
        let open = Self {
            prices: all.summed(&sums, groups),
            columns: sums,
            families,
            bursts,
            units,
            threshold: f64::NEG_INFINITY,
            threshold_of_bursts: f64::NEG_INFINITY,
            rms,
            updates: recording.updates(),
        };
        Ok(Some((open, all.only(&own))))
    }

    /// The stretch of a family, where it is one.
    pub(crate) fn burst(&self, g: usize) -> Option<&Burst> {
        self.bursts.get(g.checked_sub(self.families - self.bursts.len())?)
    }

    fn threshold_of(&self, g: usize) -> f64 {
        if self.burst(g).is_some() { self.threshold_of_bursts } else { self.threshold }
    }

    /// How far a family is beyond its threshold: negative when it is.
    pub(crate) fn beyond(&self, loud: &(usize, Score)) -> f64 {
        loud.1.ln_p - self.threshold_of(loud.0)
    }

    /// What the data alone say for a family; a stretch pays for having been chosen.
    fn likelihood(&self, g: usize) -> f64 {
        self.prices.likelihood(&[g], self.updates) - self.burst(g).map_or(0.0, |b| b.ln_chosen_from)
    }

    /// The same of a family beside effects of the library.
    pub(crate) fn likelihood_with(&self, g: usize, named: &[usize]) -> f64 {
        let mut all = self.mapped(named);
        all.push(g);
        self.prices.likelihood(&all, self.updates)
    }

    /// Groups of the library by the numbers they have in the scene.
    fn mapped(&self, named: &[usize]) -> Vec<usize> {
        named.iter().map(|g| g + self.families).collect()
    }

    /// The families that are significant on top of `named`, the most significant first. On top of effects that are there,
    /// two decades of slack: tests at the 1 % level reject true models.
    pub(crate) fn loud(&self, named: &[usize]) -> Vec<(usize, Score)> {
        let slack = if named.is_empty() { 0.0 } else { MARGIN };
        let Some(rest) = self.prices.given(&self.mapped(named)) else { return Vec::new() };
        let mut loud: Vec<(usize, Score)> =
            (0..self.families).map(|g| (g, rest.score(g))).filter(|l| self.beyond(l) < -slack).collect();
        loud.sort_by(|a, b| a.1.ln_p.total_cmp(&b.1.ln_p));
        loud
    }

    /// What family `g` gains on top of `named`.
    pub(crate) fn gain_on(&self, g: usize, named: &[usize]) -> f64 {
        let mapped = self.mapped(named);
        let mut with = mapped.clone();
        with.push(g);
        self.prices.gain(&with) - self.prices.gain(&mapped)
    }

    /// Whether each member of a set stays what it is when family `g` joins: it keeps half of its gain, or what it keeps is far more
    /// than what the family has to add.
    pub(crate) fn stand(&self, g: usize, named: &[usize]) -> bool {
        let mapped = self.mapped(named);
        let added = self.gain_on(g, named).max(1.0);
        let gain_of = |without: usize, with_family: bool| {
            let mut all = mapped.clone();
            if with_family {
                all.push(g);
            }
            let others: Vec<usize> = all.iter().copied().filter(|o| *o != without).collect();
            self.prices.gain(&all) - self.prices.gain(&others)
        };
        mapped.iter().all(|m| {
            let kept = gain_of(*m, true);
            kept > KEPT * gain_of(*m, false) || kept > FAR_MORE * added
        })
    }

    /// Families that explain what `named` explains: within 10 of its BIC, and leaving nothing for it to add; each with how far
    /// its evidence is ahead. With another log, what that says counts too: `ln_e` is what it says of `named`.
    pub(crate) fn rivals(&self, named: &[usize], other: Option<(&Self, f64)>) -> Vec<(usize, f64)> {
        if named.is_empty() {
            return Vec::new();
        }
        let mapped = self.mapped(named);
        let theirs = self.prices.likelihood(&mapped, self.updates);
        let mut rivals: Vec<(usize, f64)> = (0..self.families)
            .filter_map(|g| {
                let mut ahead = self.likelihood(g) - theirs;
                if ahead < -5.0 {
                    return None;
                }
                if let Some((other, ln_e)) = other {
                    ahead += self.carried(g, other) - ln_e;
                    if ahead < -MARGIN {
                        return None;
                    }
                }
                let rest = self.prices.given(&[g])?;
                mapped.iter().all(|n| rest.score(*n).ln_p > self.threshold).then_some((g, ahead))
            })
            .collect();
        rivals.sort_by(|a, b| b.1.total_cmp(&a.1));
        rivals.truncate(5);
        rivals
    }

    /// Log of the e-value of family `g` on another log. What happens at its time has another value there, if it happens again,
    /// and a stretch another time: then what the other log says by itself counts.
    fn carried(&self, g: usize, other: &Self) -> f64 {
        if let Some(burst) = self.burst(g) {
            let of_other = (0..other.families)
                .filter(|o| other.burst(*o).is_some_and(|there| there.triad.name == burst.triad.name));
            return of_other.map(|o| other.likelihood(o)).fold(0.0, f64::max);
        }
        let group = &self.prices.groups[g];
        let Some(there) = other.prices.groups[..other.families].iter().position(|o| o.name == group.name)
        else {
            return 0.0;
        };
        if group.name.starts_with(RANDOM_WALK) {
            return other.likelihood(there).max(0.0);
        }
        let Some((mut mean, mut covariance)) = self.prices.posterior(&[g]) else { return 0.0 };
        let scale: Vec<f64> = group
            .members
            .iter()
            .zip(&other.prices.groups[there].members)
            .map(|(a, b)| other.rms[*b] / self.rms[*a])
            .collect();
        for i in 0..scale.len() {
            mean[i] *= scale[i];
            for j in 0..scale.len() {
                covariance[(i, j)] *= WIDENED * scale[i] * scale[j];
            }
        }
        other.prices.ln_e(&[there], &mean, &covariance).unwrap_or(0.0)
    }
}

/// A second look at where a stretch begins and ends.
fn finer(scene: &Scene, burst: &Burst) -> Result<Option<Stretch>, SceneError> {
    let recording = &scene.ran.recording;
    let bounds = burst.stretch.finer(recording.span());
    let mut dictionary = Dictionary::new(&[]);
    dictionary.add_cells(recording, &burst.triad, &bounds);
    let found = run(recording, &recording.base(), &dictionary, &scene.noise, &mut |_| {})
        .ok_or(SceneError::Indefinite)?;
    let prices = Prices::new(&found.gram, dictionary.sigma, Vec::new());
    let most = Scan::new(&prices.lambda, 0).most(prices.b.as_slice());
    Ok(most.map(|((from, to), _)| {
        let lasts = burst.stretch.lasts && to + 1 == bounds.len();
        Stretch { start: bounds[from], end: bounds[to], lasts }
    }))
}
