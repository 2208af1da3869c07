/// c0 + c1 u + c2 u^2.
pub(super) struct Quadratic {
    pub c0: f64,
    pub c1: f64,
    pub c2: f64,
}

impl Quadratic {
    #[inline(always)]
    pub fn at(&self, x: f64) -> f64 {
        (self.c2 * x + self.c1) * x + self.c0
    }

    /// Whole columns of `first..=last` where it is not negative: at most two spans.
    #[inline(always)]
    pub fn spans(&self, first: f64, last: f64) -> [Option<(f64, f64)>; 2] {
        let cut = |lo: f64, hi: f64| {
            let (lo, hi) = (lo.ceil().max(first), hi.floor().min(last));
            (lo <= hi).then_some((lo, hi))
        };
        let (all_lo, all_hi) = (f64::NEG_INFINITY, f64::INFINITY);
        let discriminant = self.c1 * self.c1 - 4.0 * self.c2 * self.c0;
        if discriminant <= 0.0 || (self.c2 == 0.0 && self.c1 == 0.0) {
            return [
                if self.c2 > 0.0 || (self.c2 == 0.0 && self.c0 >= 0.0) {
                    cut(all_lo, all_hi)
                } else {
                    None
                },
                None,
            ];
        }
        // The form without cancellation; one root may be infinite when c2 = 0.
        let q = -0.5 * (self.c1 + discriminant.sqrt().copysign(self.c1));
        let (r, s) = (q / self.c2, self.c0 / q);
        if self.c2 == 0.0 {
            return [
                if self.c1 > 0.0 {
                    cut(s, all_hi)
                } else {
                    cut(all_lo, s)
                },
                None,
            ];
        }
        let (lo, hi) = (r.min(s), r.max(s));
        if self.c2 < 0.0 {
            [cut(lo, hi), None]
        } else {
            [cut(all_lo, lo), cut(hi, all_hi)]
        }
    }
}
