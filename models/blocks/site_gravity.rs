use super::units::MILLI_GAL;

effect! {
    /// Error of gravity at the site.
    ///
    /// - Equation: `d_f = dg up`. Not in the paper.
    /// - Sign: positive where gravity is stronger than the model says.
    /// - Prior: 30 mGal: what normal gravity leaves out on land.
    SiteGravity {
        table: site_gravity,
        jacobian: input,
        needs: &[],
        prior: 30.0 * MILLI_GAL,
        sheet: "mGal" = MILLI_GAL,
    }
}
