//! Stage 1: single pixels that show some depth of their own: light from elsewhere, or wrong matches of a pattern.

/// Every so many rows are looked at for whether a picture has any.
const STRIDE: usize = 16;
/// With more than this share on level surfaces a picture has them: pixels between two surfaces seldom stand alone.
const LEAST: f64 = 0.001;
/// Of the eight around it so many may agree with such a pixel: another one, by chance.
const AGREE: u8 = 1;
/// Of the eight around it so many must be measured, to say anything against it.
const MEASURED: u8 = 5;

/// The depths without single ones that differ from what is around them by more than `level` (metres); `None` where a
/// picture has next to none.
pub fn without_outliers(depth: &[f32], width: usize, level: f32) -> Option<Vec<f32>> {
    if width < 3 || depth.len() < 3 * width {
        return None;
    }
    let (mut alone, mut tested) = (0u32, 0u32);
    pulp::Arch::new().dispatch(|| {
        for v in (1..depth.len() / width - 1).step_by(STRIDE) {
            let (one, all) = alone_in(Rows::around(depth, width, v), level);
            alone += one;
            tested += all;
        }
    });
    if f64::from(alone) <= LEAST * f64::from(tested) {
        return None;
    }
    let mut out = depth.to_vec();
    pulp::Arch::new().dispatch(|| {
        for v in 1..depth.len() / width - 1 {
            let row = &mut out[v * width + 1..(v + 1) * width - 1];
            drop_from(row, Rows::around(depth, width, v), level);
        }
    });
    Some(out)
}

/// Three rows of a picture, each seen from the pixel before, at and behind.
struct Rows<'a>([[&'a [f32]; 3]; 3]);

impl<'a> Rows<'a> {
    #[inline(always)]
    fn around(depth: &'a [f32], width: usize, v: usize) -> Self {
        let row = |v: usize| {
            let row = &depth[v * width..(v + 1) * width];
            std::array::from_fn(|k| &row[k..k + width - 2])
        };
        Self([row(v - 1), row(v), row(v + 1)])
    }
}

/// How many pixels differ from four around them that agree, and how many such fours there are.
#[inline(always)]
fn alone_in(Rows([up, middle, down]): Rows, level: f32) -> (u32, u32) {
    let n = middle[1].len();
    let fours = [up[1], middle[0], middle[2], down[1]].map(|row| &row[..n]);
    let (mut alone, mut tested) = (0, 0);
    for (u, &z) in middle[1].iter().enumerate() {
        let [a, b, c, d] = fours.map(|row| row[u]);
        let low = least(least(a, b), least(c, d));
        let high = most(most(a, b), most(c, d));
        let is_level = (low > 0.0) & (high - low <= level) & (z > 0.0);
        tested += u32::from(is_level);
        alone += u32::from(is_level & ((z < low - level) | (z > high + level)));
    }
    (alone, tested)
}

/// Sets those pixels of a row to lost that stand alone.
#[inline(always)]
fn drop_from(row: &mut [f32], Rows([up, middle, down]): Rows, level: f32) {
    let n = row.len();
    let around = [
        up[0], up[1], up[2], middle[0], middle[2], down[0], down[1], down[2],
    ]
    .map(|row| &row[..n]);
    for (u, z) in row.iter_mut().enumerate() {
        let (mut agree, mut measured) = (0u8, 0u8);
        for row in around {
            let other = row[u];
            measured += u8::from(other > 0.0);
            agree += u8::from((other - *z).abs() <= level);
        }
        let alone = (agree <= AGREE) & (measured >= MEASURED);
        *z = if alone { 0.0 } else { *z };
    }
}

#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}
