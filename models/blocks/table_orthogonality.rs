use super::units::ARCSEC;

effect! {
    /// Axes of a three-axis table that are not square, where it reports the attitude as if they were.
    ///
    /// - Frame: the outer axis o stands along up, the inner one i along x of b, and the middle one along `o x i`.
    /// - Equation: `C_ref = (I - [(om o x m + mi m x i) x]) C`, `m = o x i`. Not in the paper. It shows only where attitude is
    ///   measured.
    /// - Sign: positive where the angle between outer and middle (om) or middle and inner axis (mi) is more than 90 deg.
    /// - Where: exact where outer and inner axis are square, and less by the sine of the angle between them elsewhere. Where they are
    ///   parallel an attitude does not tell which angles the table has, and nothing is said.
    /// - Prior: 5 arcsec.
    TableOrthogonality {
        table: table_orthogonality,
        jacobian: measurement,
        needs: &[],
        prior: 5.0 * ARCSEC,
        sheet: "arcsec" = ARCSEC,
    }
}
