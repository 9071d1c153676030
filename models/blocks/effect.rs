/// Declares the block of an effect: a unit type with [`Block`](calib_core::Block) and
/// [`Effect`](crate::Effect).
///
/// `table` is the module of [`tables`](crate::tables) that knows names, unit and Jacobian; `jacobian` is
/// `input` for an error of the sensors and `measurement` for one of the reference; `sheet` is the unit of
/// data sheets and its size in SI; `kin` is the effect that its size goes with, if there is one; `relaxes` says how its states forget,
/// where they are not constant.
macro_rules! effect {
    (
        $(#[$doc:meta])*
        $name:ident {
            table: $table:ident,
            jacobian: $jacobian:ident,
            needs: $needs:expr,
            prior: $prior:expr,
            sheet: $unit:literal = $scale:expr,
            $(kin: $kin:literal,)?
            $(relaxes: $relaxes:expr,)?
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl calib_core::Block for $name {
            type Dynamics = $crate::Strapdown;
            type View<'a, T: calib_core::Real> = calib_core::BlockView<'a, Self, T>;

            const NAME: &'static str = $crate::tables::$table::TABLE.name;
            const DIM: usize = $crate::tables::$table::TABLE.components.len();
            const NEEDS: &'static [calib_core::Need] = $needs;
            $(const RELAXATIONS: &'static [(usize, calib_core::Relaxation<f64>)] = &{
                let relaxes: calib_core::Relaxation<f64> = $relaxes;
                let mut all = [(0, relaxes); $crate::tables::$table::TABLE.components.len()];
                let mut state = 0;
                while state < all.len() {
                    all[state].0 = state;
                    state += 1;
                }
                all
            };)?

            fn states(visit: &mut dyn FnMut(calib_core::StateInfo)) {
                <Self as $crate::Effect>::EFFECT.states(visit);
            }

            effect!(@jacobian $jacobian $table);
        }

        impl calib_core::Counted for $name {
            type States = calib_core::declare::Size<{ <$name as calib_core::Block>::DIM }>;
        }

        impl $crate::Effect for $name {
            const EFFECT: $crate::EffectInfo =
                $crate::EffectInfo::tabled(&$crate::tables::$table::TABLE, $prior)
                    .sheet($unit, $scale)
                    $(.akin_to($kin))?;
        }
    };
    (@jacobian input $table:ident) => {
        #[inline(always)]
        fn input_jacobian<T: calib_core::Real>(
            signals: &$crate::Signals<T>,
            put: &mut impl FnMut(usize, usize, T),
        ) {
            $crate::tables::$table::input_jacobian(signals, put);
        }
    };
    (@jacobian measurement $table:ident) => {
        #[inline(always)]
        fn measurement_jacobian<T: calib_core::Real>(
            at: &$crate::Point<T>,
            put: &mut impl FnMut(usize, usize, T),
        ) {
            $crate::tables::$table::measurement_jacobian(at, put);
        }
    };
}
