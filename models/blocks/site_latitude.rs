use super::units::ARCSEC;

effect! {
    /// Error of the latitude that is stated of the site.
    ///
    /// - Equation: `d_omega = d omega_ie/dL dL`, `d_f = dg/dL dL up`. Not in the paper.
    /// - Sign: positive where the site is further north than stated.
    /// - Prior: 3.6 arcsec, 0.001 deg: a map.
    SiteLatitude {
        table: site_latitude,
        jacobian: input,
        needs: &[],
        prior: 3.6 * ARCSEC,
        sheet: "arcsec" = ARCSEC,
    }
}
