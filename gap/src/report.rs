//! What a diagnosis says, for people and for machines.

use serde::Serialize;

/// The outcome in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Effects are missing and named.
    EffectsFound,
    /// Nothing significant is missing.
    NothingMissing,
    /// Something is missing that no known effect explains.
    OutsideLibrary,
    /// Several sets of effects explain the data equally well.
    Ambiguous,
    /// A set of effects explains this log, but the check of it failed.
    NotConfirmed,
}

/// An effect that was found missing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundEffect {
    /// Name in the vocabulary, or of the user's own block.
    pub name: String,
    /// Components, in order.
    pub components: Vec<String>,
    /// Estimates from the filter that was really run, SI.
    pub estimate: Vec<f64>,
    /// Their standard deviations, SI.
    pub sigma: Vec<f64>,
    /// Estimates from the second log, where there is one.
    pub estimate_verify: Option<Vec<f64>>,
    /// SI unit.
    pub unit: String,
    /// Unit of data sheets.
    pub sheet_unit: String,
    /// Size of one of them, SI.
    pub sheet_scale: f64,
    /// The model in plain text.
    pub equation: String,
    /// One line about it.
    pub description: String,
    /// What it gains in log-likelihood on top of the other effects found.
    pub log_likelihood_gain: f64,
    /// Natural logarithm of its e-value on the second log, or on the second half of the only one.
    pub log_e_verify: f64,
}

/// Where the missing effect shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Beginning of the stretch, s.
    pub start_s: f64,
    /// End of the stretch, s.
    pub end_s: f64,
    /// Measurement channel, for instance `vel_n`.
    pub channel: String,
    /// Matched-filter gain in log-likelihood.
    pub gain: f64,
}

/// How one effect fares against the set that was chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rival {
    /// Name.
    pub name: String,
    /// log10 of its p-value on top of the base filter.
    pub log10_p_before: f64,
    /// log10 of its p-value on top of the chosen set.
    pub log10_p_after: f64,
    /// Log-likelihood that it gains on its own.
    pub gain_alone: f64,
    /// Log-likelihood that it gains on top of the chosen set; for a member, on top of the others.
    pub gain_on_top: f64,
    /// Log-likelihood that the chosen set gains on top of it.
    pub chosen_on_top: f64,
    /// Standard deviations that an effect of its prior's size would show in its best direction.
    pub excitation: f64,
    /// What the log says of its components, SI, row by row: an effect theta shows at the root of theta' I theta standard
    /// deviations.
    #[serde(skip)]
    pub information: Vec<f64>,
}

/// Factors on the stated noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseScale {
    /// On the angle random walk.
    pub gyro: f64,
    /// On the velocity random walk.
    pub accel: f64,
    /// On the reference's standard deviations.
    pub reference: f64,
}

/// The gap on one log, before and after the effects were added; both filters really run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LogGap {
    /// Root mean square of the normalised innovations before; 1 when prediction and data agree.
    pub rms_before: f64,
    /// The same after.
    pub rms_after: f64,
    /// Log-likelihood of the innovations before, under the fitted noise.
    pub log_likelihood_before: f64,
    /// The same after.
    pub log_likelihood_after: f64,
    /// What pricing said that the difference would be.
    pub log_likelihood_gain_priced: f64,
    /// Error of a prediction without updates over [`horizon_s`](Self::horizon_s), before: root mean square.
    pub free_run_before: f64,
    /// The same after.
    pub free_run_after: f64,
    /// What the prediction is of: `velocity` in m/s or `position` in m.
    pub free_run_of: &'static str,
    /// Length of each prediction, s.
    pub horizon_s: f64,
    /// Free-inertial navigation of the log with what the first log said, where the observed point stands still.
    pub horizontal: Option<Horizontal>,
}

/// Largest horizontal error of free-inertial navigation, height held, after an alignment of a quarter of the log, at most 900 s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Horizontal {
    /// With the parameters of the declared filter, m.
    pub before_m: f64,
    /// With those of the extended filter, m.
    pub after_m: f64,
}

/// Whether the whitened innovations are white: Ljung-Box over all channels together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Whiteness {
    /// Autocorrelations tested in each channel.
    pub lags: usize,
    /// log10 of the p-value of the filter as declared.
    pub log10_p_before: f64,
    /// The same with what was found, at the values found.
    pub log10_p_after: f64,
}

/// What remains on top of what was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Remainder {
    /// What it gains of all that is explained with it.
    pub share: f64,
    /// The most that any one effect or family of the dictionary gains on top of what was found.
    pub log_likelihood: f64,
    /// Those that gain at least half of that, the largest first: what it goes with.
    pub families: Vec<String>,
}

/// Something in no library as an equation of what was measured: how it goes, and not why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundLaw {
    /// What it goes with, for instance `accel-bias-by-temperature-rate-squared`.
    pub name: String,
    /// In plain text; i is the sensor's own axis, j and k are the next two.
    pub equation: String,
    /// The axes.
    pub components: Vec<String>,
    /// Known effects that explain the rest beside it.
    pub beside: Vec<String>,
    /// Coefficients from the filter that was really run, SI.
    pub estimate: Vec<f64>,
    /// Their standard deviations, SI.
    pub sigma: Vec<f64>,
    /// Coefficients from the second log.
    pub estimate_verify: Vec<f64>,
    /// SI unit.
    pub unit: String,
    /// What it gains in log-likelihood on top of the known effects beside it.
    pub log_likelihood_gain: f64,
    /// Natural logarithm of its e-value on the second log.
    pub log_e_verify: f64,
    /// Laws of other forms that both logs cannot tell from it, the nearest first.
    pub rivals: Vec<String>,
}

/// The gap on both logs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// On the log that was diagnosed.
    pub fit: LogGap,
    /// On the second log.
    pub verify: Option<LogGap>,
}

/// What the log as a whole says over time: how the evidence for the chosen set grew.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Time, s.
    pub time_s: f64,
    /// Matched-filter gain so far.
    pub gain: f64,
}

/// The finding of a diagnosis. Serialises to the documented JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// The outcome in one word.
    pub verdict: Verdict,
    /// The outcome in a sentence for people; what else there is to know follows in [`notes`](Self::notes).
    pub sentence: String,
    /// Whether a second log bears it out.
    pub verified: bool,
    /// Whether nothing significant remains unexplained.
    pub complete: bool,
    /// What remains on top of what was found, where something does.
    pub remainder: Option<Remainder>,
    /// The filter that was diagnosed.
    pub base_filter: String,
    /// How many logs of the unit were taken as one.
    pub logs: usize,
    /// The effects found and confirmed.
    pub effects: Vec<FoundEffect>,
    /// Sets of effects that explain the data equally well, or that failed the check.
    pub ambiguous: Vec<Vec<String>>,
    /// Effects that this path cannot show.
    pub not_excited: Vec<String>,
    /// Pairs that this path cannot tell apart; the second may belong to the base filter.
    pub indistinguishable: Vec<Vec<String>>,
    /// What the unexplained part goes with.
    pub correlates_with: Vec<String>,
    /// Equations for what is in no library, each borne out by the second log.
    pub laws: Vec<FoundLaw>,
    /// Where it shows, the strongest first.
    pub r#where: Vec<Place>,
    /// Noise fitted under the filter with every candidate.
    pub noise_scale: NoiseScale,
    /// Whether the innovations are white under that noise.
    pub whiteness: Option<Whiteness>,
    /// The gap before and after.
    pub gap: Option<Gap>,
    /// Path of the written Rust source; the program fills it in.
    pub declaration: Option<String>,
    /// The Rust source of the extended filter.
    pub source: Option<String>,
    /// All candidates against the chosen set.
    pub rivals: Vec<Rival>,
    /// How the evidence grew.
    pub evidence: Vec<Evidence>,
    /// Further sentences for people.
    pub notes: Vec<String>,
    /// What the next run should do.
    pub next_run: Vec<String>,
}

impl Diagnosis {
    /// What was diagnosed, as sentences call it.
    pub fn called(&self) -> &'static str {
        if self.logs > 1 { "these logs" } else { "this log" }
    }

    /// Pairs of effects that another run would have to part: where one set that explains the data has one and another set
    /// the other, and what this path cannot tell from a member of a set.
    pub fn undecided(&self) -> Vec<(String, String)> {
        let mut pairs: Vec<(String, String)> = Vec::new();
        let mut add = |a: &String, b: &String| {
            if !pairs.iter().any(|p| p.0 == *a && p.1 == *b || p.0 == *b && p.1 == *a) {
                pairs.push((a.clone(), b.clone()));
            }
        };
        if let Some((best, others)) = self.ambiguous.split_first() {
            for other in others {
                for a in best.iter().filter(|a| !other.contains(a)) {
                    other.iter().filter(|b| !best.contains(b)).for_each(|b| add(a, b));
                }
            }
            for pair in &self.indistinguishable {
                if best.contains(&pair[0]) || best.contains(&pair[1]) {
                    add(&pair[0], &pair[1]);
                }
            }
        }
        pairs
    }
}
