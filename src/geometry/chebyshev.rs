//! Chebyshev polynomials of the first kind.

/// The values `T_n(t)` and derivatives `T_n'(t)` for n = 0, 1, 2, …, without end.
pub fn chebyshev(t: f64) -> impl Iterator<Item = (f64, f64)> {
    // T_-1 = T_1 = t starts the recurrence T_n+1 = 2 t T_n - T_n-1, and T_-1' = T_1' that of the derivatives.
    let mut older = (t, 1.0);
    let mut next = (1.0, 0.0);
    std::iter::repeat_with(move || {
        let term = next;
        next = (2.0 * t * term.0 - older.0, 2.0 * (term.0 + t * term.1) - older.1);
        older = term;
        term
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_slopes_are_those_of_the_cosine() {
        for t in [-0.9, 0.0, 0.3, 0.99_f64] {
            let angle = t.acos();
            for (n, (value, slope)) in chebyshev(t).take(12).enumerate() {
                let n = n as f64;
                let exact = ((n * angle).cos(), n * (n * angle).sin() / angle.sin());
                assert!((value - exact.0).abs() < 1e-13 && (slope - exact.1).abs() < 1e-11, "T_{n}({t})");
            }
        }
    }
}
