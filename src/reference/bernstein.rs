//! Polynomials of any degree on [0, 1] by their Bernstein ordinates: products, and where they pass zero.

use smallvec::{SmallVec, smallvec};

/// Bernstein ordinates, one more than the degree.
pub type Ordinates = SmallVec<[f64; 8]>;

/// How often an interval is halved in the search for a zero: to the last bit of [0, 1].
const HALVINGS: u32 = 52;

/// The product of two polynomials (Farouki and Rajan 1988).
pub fn product(a: &[f64], b: &[f64]) -> Ordinates {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let mut product: Ordinates = smallvec![0.0; m + n + 1];
    for i in 0..=m {
        for j in 0..=n {
            let share = choose(m, i) * choose(n, j) / choose(m + n, i + j);
            product[i + j] += share * a[i] * b[j];
        }
    }
    product
}

/// The sum of polynomials of one degree.
pub fn sum(a: &[f64], b: &[f64]) -> Ordinates {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Passes on where a polynomial is positive on one side and not on the other, between 0 and 1; where it touches zero
/// from above, too. Its sign changes no more often than its ordinates' does, so that halves whose ordinates have one
/// sign are left out (Lane and Riesenfeld 1981).
pub fn each_zero(ordinates: &[f64], found: &mut impl FnMut(f64)) {
    search(ordinates.into(), (0.0, 1.0), HALVINGS, found);
}

fn search(
    ordinates: Ordinates,
    (from, to): (f64, f64),
    halvings: u32,
    found: &mut impl FnMut(f64),
) {
    let is_positive = |v: &f64| *v > 0.0;
    if ordinates.iter().all(is_positive) || !ordinates.iter().any(is_positive) {
        return;
    }
    let middle = 0.5 * (from + to);
    if halvings == 0 {
        return found(middle);
    }
    let (near, far) = halved(ordinates);
    search(near, (from, middle), halvings - 1, found);
    search(far, (middle, to), halvings - 1, found);
}

/// The ordinates of both halves, by de Casteljau's algorithm.
fn halved(mut ordinates: Ordinates) -> (Ordinates, Ordinates) {
    let count = ordinates.len();
    let mut near = Ordinates::with_capacity(count);
    for left in (1..=count).rev() {
        near.push(ordinates[0]);
        for i in 1..left {
            ordinates[i - 1] = 0.5 * ordinates[i - 1] + 0.5 * ordinates[i];
        }
    }
    // What is left stands from the last value of each round on.
    let far = ordinates;
    (near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zeros(ordinates: &[f64]) -> Vec<f64> {
        let mut all = Vec::new();
        each_zero(ordinates, &mut |at| all.push(at));
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        all
    }

    #[test]
    fn a_product_of_lines_is_zero_where_they_are() {
        let roots = [0.1, 0.35, 0.5, 0.350_001, 0.9, 0.77];
        let line = |root: f64| [-root, 1.0 - root];
        let first: Ordinates = line(roots[0]).as_slice().into();
        let all = roots[1..]
            .iter()
            .fold(first, |all, root| product(&all, &line(*root)));
        let mut sorted = roots.to_vec();
        sorted.sort_by(f64::total_cmp);
        let found = zeros(&all);
        assert_eq!(found.len(), sorted.len(), "{found:?}");
        for (found, root) in found.iter().zip(&sorted) {
            assert!((found - root).abs() < 1e-9, "{found} {root}");
        }
        // The control: outside there are none.
        assert_eq!(zeros(&product(&line(-0.5), &line(1.5))), Vec::<f64>::new());
    }

    #[test]
    fn a_product_has_the_factors_product_everywhere() {
        let (a, b) = ([1.0, -2.0, 0.5, 3.0], [0.25, -1.0]);
        let at = |ordinates: &[f64], s: f64| {
            let n = ordinates.len() - 1;
            let term = |k: usize| {
                choose(n, k) * s.powi(k as i32) * (1.0 - s).powi((n - k) as i32) * ordinates[k]
            };
            (0..=n).map(term).sum::<f64>()
        };
        for s in [0.0, 0.2, 0.7, 1.0] {
            let expected = at(&a, s) * at(&b, s);
            assert!((at(&product(&a, &b), s) - expected).abs() < 1e-14);
            assert!((at(&product(&a, &b), s) - expected - 1e-6).abs() > 1e-14);
        }
        let (near, far) = halved(a.as_slice().into());
        assert!((at(&near, 0.5) - at(&a, 0.25)).abs() < 1e-14);
        assert!((at(&far, 0.5) - at(&a, 0.75)).abs() < 1e-14);
    }
}
