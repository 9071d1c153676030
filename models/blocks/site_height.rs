effect! {
    /// Error of the height that is stated of the site.
    ///
    /// - Equation: `d_f = dg/dh dh up`. Not in the paper.
    /// - Sign: positive where the site is higher than stated: gravity is then less.
    /// - Prior: 3 m: a map, and which ellipsoid it goes by.
    SiteHeight {
        table: site_height,
        jacobian: input,
        needs: &[],
        prior: 3.0,
        sheet: "m" = 1.0,
    }
}
