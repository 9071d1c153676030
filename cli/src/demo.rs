//! `sinscal demo`: the main job on a simulated unit, without any file.

use std::fmt::Write as _;
use std::time::Instant;

use clap::Args;
use miette::{IntoDiagnostic, Result, miette};
use rig::{Scenario, Simulation, Truth};
use sinscal::{Calibration, Filter, FilterVisitor, Parameter, Strapdown};

use crate::figures::{decimals, significant};
use crate::output;

/// The filter that knows everything the simulated unit does.
const COMPLETE: &str = "43d-b";
/// The filter that lacks the inner lever arm, the delay, the temperature and the dither.
const LACKING: &str = "36d-p";

/// Draw a unit, simulate its calibration run, calibrate it and compare with the truth
#[derive(Args)]
pub(crate) struct Arguments {
    /// Which unit of the population is drawn
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let scenario = Scenario::default();
        let started = Instant::now();
        let simulation = || Simulation::new(&scenario, self.seed).into_diagnostic();
        let truth = simulation()?.truth().clone();
        let mut text = format!(
            "unit {} of the default population, on the path of 18 rotations: {:.0} s, {} samples\n",
            self.seed,
            scenario.duration(),
            scenario.samples()
        );
        for name in [LACKING, COMPLETE] {
            let found = sinscal::visit_filter(name, Calibrate { simulation: simulation()? })
                .unwrap_or_else(|| Err(miette!("there is no filter called {name}")))?;
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{name}: NIS per degree of freedom {:.2}, largest error {:.1} sigma",
                found.nis_per_dof,
                found.parameters.iter().map(|p| error(p, &truth).abs()).fold(0.0, f64::max)
            );
            if name == COMPLETE {
                text.push_str(&table(&found.parameters, &truth));
            }
        }
        let _ = writeln!(text, "simulated and calibrated twice in {:.1} s", started.elapsed().as_secs_f64());
        output::print(&text)
    }
}

/// Estimates beside the truth, in data-sheet units.
fn table(parameters: &[Parameter], truth: &Truth) -> String {
    let mut text = format!(
        "\n{:30} {:>12}   {:9} {:9} {:>10}  error\n",
        "parameter", "estimate", "+- sigma", "unit", "truth"
    );
    for parameter in parameters {
        let info = &parameter.info;
        let sigma = parameter.sigma / info.sheet_scale;
        let digits = decimals(sigma);
        let name = format!("{} {}", info.block, info.component);
        let _ = writeln!(
            text,
            "{name:30} {:12.digits$}   {:9} {:9} {:10.digits$}  {:+.1} sigma",
            parameter.value / info.sheet_scale,
            significant(sigma),
            info.sheet_unit,
            truth.of(info) / info.sheet_scale,
            error(parameter, truth)
        );
    }
    text.push('\n');
    text
}

/// Error of an estimate by its sigma.
fn error(parameter: &Parameter, truth: &Truth) -> f64 {
    (parameter.value - truth.of(&parameter.info)) / parameter.sigma
}

/// Calibrates while it is simulated: no log is kept.
struct Calibrate {
    simulation: Simulation,
}

/// What a calibration found.
struct Found {
    nis_per_dof: f64,
    parameters: Vec<Parameter>,
}

impl FilterVisitor for Calibrate {
    type Output = Result<Found>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let description = self.simulation.description().clone();
        let mut run = Box::new(Calibration::<F>::new(&description.setup(&[])));
        for sample in self.simulation {
            run.step(&sample).into_diagnostic()?;
        }
        let mut parameters = Vec::new();
        run.parameters(&mut |parameter| parameters.push(parameter));
        Ok(Found { nis_per_dof: run.statistics().nis_per_dof(), parameters })
    }
}
