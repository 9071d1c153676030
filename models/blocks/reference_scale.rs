use super::units::PPM;

effect! {
    /// Scale of the reference's velocity and position.
    ///
    /// - Equation: `reading = (1 + s) x`. Not in the paper.
    /// - Sign: positive where the reference reads too much.
    /// - Prior: 100 ppm.
    ReferenceScale {
        table: reference_scale,
        jacobian: measurement,
        needs: &[],
        prior: 1e-4,
        sheet: "ppm" = PPM,
    }
}
