//! A declared filter, whatever its sizes.

use core::any::TypeId;
use core::marker::PhantomData;

use calib_core::{Block, BlockVisitor, Dynamics, Filter, Sizes, considered_in};
use sinscal::navigation::Pilot;
use sinscal::{AnyBlock, Corrector, FilterInfo, Setup, StateInfo, Strapdown};

use crate::Error;
use crate::compiled::{About, Compiled, Of, Selection};
use crate::foresee::Piece;
use crate::observe::Analysis;
use crate::pool::pool;
use crate::running::{Options, Running};
use crate::samples::Samples;
use crate::trace::{Trace, Traced};

/// What every declared filter can do, without its type: what commands, campaigns and diagnoses are written for.
pub trait AnyFilter: Send + Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// Path of the type that declares it.
    fn path(&self) -> &'static str;

    /// What it holds, in a few words.
    fn about(&self) -> String;

    /// Passes over a log that a unit of its class needs.
    fn passes(&self) -> u32;

    /// Names of the measurements, in order.
    fn measures(&self) -> Vec<&'static str>;

    /// Columns of a log that its measurements read and a reference has no field for, in the order of
    /// [`Reference::own`](sinscal::Reference::own).
    fn own_columns(&self) -> Vec<&'static str>;

    /// The states in order.
    fn states(&self) -> Vec<StateInfo>;

    /// The blocks that it is made of, in the order of their states.
    fn blocks(&self) -> Vec<Leaf>;

    /// The code that runs it, and which of that code's states take part.
    fn compiled(&self) -> (&'static dyn Compiled, &Selection);

    /// The code of a filter with the same measurements and everything that can be estimated, for what is composed at run time.
    fn pool(&self) -> &'static Pool;

    /// The setup of a run, with what the filter itself says of it.
    fn prepare<'a>(&'a self, setup: &Setup<'a>, priors: &'a mut Vec<(&'a str, f64)>) -> Setup<'a> {
        let _ = priors;
        *setup
    }

    /// Names of the effects that were added to it.
    fn with(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Names of the blocks whose states are considered: no measurement changes them, and what they make uncertain is in the covariance of
    /// the others.
    fn considers(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// The filter that it was before states were added to be considered, where there is one: it estimates the same.
    fn exact(&self) -> Option<&dyn AnyFilter> {
        None
    }

    /// Names of the blocks that were left out of it.
    fn without(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// What people call it: its name, what was added to it, and what was left out.
    fn title(&self) -> String {
        let considers = self.considers();
        let with = self.with().into_iter().filter(|name| !considers.contains(name));
        let with = with.map(|name| format!(" + {name}"));
        let without = self.without().into_iter().map(|name| format!(" - {name}"));
        let of = match considers.as_slice() {
            [] => None,
            [_, _, _, ..] => Some(format!(" (considering {} effects)", considers.len())),
            few => Some(format!(" (considering {})", few.join(" and "))),
        };
        with.chain(without).chain(of).fold(self.name().to_owned(), |title, part| title + &part)
    }

    /// Whether the states of the block called `name` change in the course of a run.
    fn changes(&self, name: &str) -> bool {
        let mut changes = false;
        for leaf in self.blocks().iter().filter(|leaf| leaf.name == name) {
            leaf.block.relaxation(&mut |_, _| changes = true);
        }
        changes
    }

    /// The states after those of the navigation, in order.
    fn parameters(&self) -> Vec<StateInfo> {
        self.states().split_off(<Strapdown as Dynamics>::CORE)
    }

    /// Whether it takes the size effect of the dither from the places of the accelerometers: it then needs a log that tells the
    /// dither.
    fn needs_dither(&self) -> bool {
        self.blocks().iter().any(|leaf| leaf.is::<sinscal::Dither>())
    }
}

/// A block of a declaration that is written by hand.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// Its type.
    pub id: TypeId,
    /// Its name.
    pub name: &'static str,
    /// Its first state within the declaration.
    pub first: usize,
    /// What it says.
    pub block: &'static dyn AnyBlock,
}

impl Leaf {
    /// Whether it is block `B`.
    pub fn is<B: Block>(&self) -> bool {
        self.id == TypeId::of::<B>()
    }

    /// What tells blocks apart; laws are of one type.
    pub(crate) fn identity(&self) -> (TypeId, &'static str) {
        (self.id, self.name)
    }
}

/// The blocks of declaration `F`.
pub(crate) fn leaves<F: Block<Dynamics = Strapdown>>() -> Vec<Leaf> {
    struct Leaves(Vec<Leaf>);
    impl BlockVisitor<Strapdown> for Leaves {
        fn visit<B: Block<Dynamics = Strapdown>>(&mut self, first: usize) {
            let (id, block) = (TypeId::of::<B>(), <dyn AnyBlock>::of::<B>());
            self.0.push(Leaf { id, name: B::NAME, first, block });
        }
    }
    let mut leaves = Leaves(Vec::new());
    F::blocks(0, &mut leaves);
    leaves.0
}

/// A filter to compose others of.
pub struct Pool {
    /// Its code.
    pub(crate) code: &'static dyn Compiled,
    /// Its blocks.
    pub(crate) blocks: fn() -> Vec<Leaf>,
}

impl Pool {
    pub(crate) const fn of<F: Filter<Dynamics = Strapdown>>() -> &'static Self {
        const { &Self { code: &Of::<F>::NEW, blocks: leaves::<F> } }
    }
}

/// The declared filter `F`.
pub struct Declared<F> {
    info: FilterInfo,
    selection: Selection,
    of: PhantomData<fn() -> F>,
}

impl<F: Filter<Dynamics = Strapdown>> Declared<F> {
    /// `F` with the number of passes that its class of units needs, and what it holds in a few words.
    pub fn new(passes: u32, about: &'static str) -> Self {
        Self { info: FilterInfo::of::<F>(passes, about), selection: Selection::all::<F>(), of: PhantomData }
    }
}

impl<F: Filter<Dynamics = Strapdown, Shape: Sizes>> AnyFilter for Declared<F> {
    fn name(&self) -> &'static str {
        F::NAME
    }

    fn path(&self) -> &'static str {
        core::any::type_name::<F>()
    }

    fn about(&self) -> String {
        self.info.about.to_owned()
    }

    fn passes(&self) -> u32 {
        self.info.passes
    }

    fn measures(&self) -> Vec<&'static str> {
        self.info.measures().collect()
    }

    fn own_columns(&self) -> Vec<&'static str> {
        sinscal::own_columns::<F>().collect()
    }

    fn states(&self) -> Vec<StateInfo> {
        let mut states = Vec::with_capacity(F::DIM);
        F::states(&mut |state| states.push(state));
        states
    }

    fn blocks(&self) -> Vec<Leaf> {
        leaves::<F>()
    }

    fn considers(&self) -> Vec<&'static str> {
        let mut considered = vec![false; F::DIM];
        considered_in::<F>(|state| considered[state] = true);
        let mut names = Vec::new();
        for (info, considered) in self.states().iter().zip(considered) {
            if considered && !names.contains(&info.block) {
                names.push(info.block);
            }
        }
        names
    }

    fn compiled(&self) -> (&'static dyn Compiled, &Selection) {
        (const { &Of::<F>::NEW }, &self.selection)
    }

    fn pool(&self) -> &'static Pool {
        pool::<F>()
    }
}

impl dyn AnyFilter + '_ {
    /// Starts it; samples are handed over pass by pass.
    pub fn start(&self, setup: &Setup, options: &Options) -> Box<dyn Running> {
        let (code, selection) = self.compiled();
        code.start(self.title(), &self.prepare(setup, &mut Vec::new()), options, selection)
    }

    /// Looks at a log with its eyes.
    ///
    /// # Errors
    /// When the log cannot be read.
    pub fn observe(&self, samples: &dyn Samples, setup: &Setup) -> Result<Analysis, Error> {
        let (code, selection) = self.compiled();
        code.observe(samples, &self.prepare(setup, &mut Vec::new()), selection)
    }

    /// Standard deviations of the parameters, in their order, as a pass over a motion that is known beforehand will state them.
    ///
    /// # Errors
    /// When the covariance breaks down.
    pub fn foresee(&self, ahead: &mut dyn Iterator<Item = Piece>, setup: &Setup) -> Result<Vec<f64>, Error> {
        let (code, selection) = self.compiled();
        code.foresee(ahead, &self.prepare(setup, &mut Vec::new()), selection)
    }

    /// Takes the first guess of the outer lever arm out of values of the parameters, which as people know them include it.
    pub fn without_guess(&self, setup: &Setup, values: &mut [f64]) {
        let core = <Strapdown as Dynamics>::CORE;
        if let Some(leaf) = self.blocks().iter().find(|leaf| leaf.is::<sinscal::OuterLeverArm>()) {
            for axis in 0..3 {
                values[leaf.first - core + axis] -= setup.outer_lever[axis];
            }
        }
    }

    /// A pilot with known values of the parameters, the outer lever arm without its first guess.
    pub fn pilot_with(&self, setup: &Setup, values: &[f64]) -> Box<dyn Pilot> {
        let (code, selection) = self.compiled();
        code.pilot(&self.prepare(setup, &mut Vec::new()), selection, values)
    }

    /// What takes out of samples the errors of known parameters, by name as in `navigate`.
    pub fn corrector(&self, setup: &Setup, value: &mut dyn FnMut(&StateInfo) -> Option<f64>) -> Corrector {
        let mut values: Vec<f64> = self.parameters().iter().map(|info| value(info).unwrap_or(0.0)).collect();
        self.without_guess(setup, &mut values);
        let (code, selection) = self.compiled();
        code.corrector(&self.prepare(setup, &mut Vec::new()), selection, &values)
    }

    /// Runs a pass with the parameters taken as known, and tells the linear system that it is.
    ///
    /// # Errors
    /// When the log cannot be read or the filter diverges.
    pub fn trace(
        &self,
        samples: &dyn Samples,
        setup: &Setup,
        about: &About,
        trace: &mut dyn Trace,
    ) -> Result<Traced, Error> {
        let (code, selection) = self.compiled();
        code.trace(samples, &self.prepare(setup, &mut Vec::new()), selection, about, trace)
    }

    /// A pilot with known parameters, by name; one without a value is zero, and the outer lever arm, as people know it, includes its
    /// first guess.
    pub fn pilot(&self, setup: &Setup, value: &mut dyn FnMut(&StateInfo) -> Option<f64>) -> Box<dyn Pilot> {
        let mut values: Vec<f64> = self.parameters().iter().map(|info| value(info).unwrap_or(0.0)).collect();
        self.without_guess(setup, &mut values);
        self.pilot_with(setup, &values)
    }
}
