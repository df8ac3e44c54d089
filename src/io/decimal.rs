//! Numbers as text: metres of the core as millimetres of a file, by moving the decimal point, not by a multiplication.

use crate::geometry::DVec3;
use crate::units::to_mm;

/// Decimal places between the metres of the core and the millimetres of our files.
pub(super) const MM_DIGITS: i32 = 3;

/// Characters in a wide field of a card format.
const WIDE_FIELD: usize = 16;

/// The coordinates of a place (m) as text in mm: "1.5 0 -0.035", exactly.
pub(super) fn millimetres(place: DVec3) -> String {
    let [x, y, z] = place.to_array().map(|c| shifted_digits(c, MM_DIGITS));
    format!("{x} {y} {z}")
}

/// A length (m) in mm as a real number of at most 16 characters, with a point: exact where its digits fit, else rounded
/// to the last place that does, which is 1e-10 mm or finer below a metre.
pub(super) fn wide_field(length: f64) -> String {
    let mut text = shifted_digits(length, MM_DIGITS);
    if !text.contains('.') {
        // "10" would be an integer, and "1e-9" has its point before the exponent.
        text.insert_str(text.find('e').unwrap_or(text.len()), ".0");
    }
    if text.len() <= WIDE_FIELD {
        return text;
    }
    let mm = to_mm(length);
    let fits = |text: &String| text.len() <= WIDE_FIELD;
    let fixed = (1..WIDE_FIELD - 2).rev().map(|places| format!("{mm:.places$}"));
    let mut fixed = fixed.filter(|_| mm.abs() < 1e10).filter(fits);
    fixed.next().unwrap_or_else(|| format!("{mm:.8e}"))
}

/// The shortest decimal digits that give `value` back, times ten to the power `digits`, exactly.
pub(super) fn shifted_digits(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:e}");
    let (mantissa, exponent) = scientific.split_once('e').expect("the format has an exponent");
    let exponent = exponent.parse::<i32>().expect("an exponent of at most three digits") + digits;
    let (sign, mantissa) = mantissa.strip_prefix('-').map_or(("", mantissa), |rest| ("-", rest));
    let plain: String = mantissa.chars().filter(|&c| c != '.').collect();
    match usize::try_from(exponent) {
        Ok(whole) if whole + 1 < plain.len() => format!("{sign}{}.{}", &plain[..=whole], &plain[whole + 1..]),
        Ok(whole) if whole < 16 => format!("{sign}{plain:0<width$}", width = whole + 1),
        Err(_) if exponent > -7 => format!("{sign}0.{}{plain}", "0".repeat((-exponent - 1).unsigned_abs() as usize)),
        _ => format!("{sign}{mantissa}e{exponent}"),
    }
}

/// Parses a finite number and divides it by ten to the power `digits` with a single rounding.
pub(super) fn number(word: &str, digits: i32) -> Option<f64> {
    let value: f64 = word.parse().ok().filter(|v: &f64| v.is_finite())?;
    if digits == 0 {
        return Some(value);
    }
    let (mantissa, exponent) = word.split_once(['e', 'E']).unwrap_or((word, "0"));
    match exponent.parse::<i32>().ok().and_then(|e| e.checked_sub(digits)) {
        Some(exponent) => format!("{mantissa}e{exponent}").parse().ok(),
        // Finite with an exponent beyond 32 bits: its digits are all zero, or it is far below the smallest number.
        None => Some(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millimetres_in_text_are_metres_bit_for_bit() {
        let mut rng = fastrand::Rng::with_seed(41);
        for case in 0..20_000 {
            let value = (rng.f64() - 0.5) * 10_f64.powi(rng.i32(-9..4));
            let text = shifted_digits(value, MM_DIGITS);
            assert_eq!(
                number(&text, MM_DIGITS).map(f64::to_bits),
                Some(value.to_bits()),
                "case {case}: {value:e} {text}"
            );
            let mm: f64 = text.parse().unwrap();
            assert!((mm - value * 1e3).abs() <= 4.0 * f64::EPSILON * mm.abs(), "{value:e} m is {text} mm");
        }
    }

    #[test]
    fn digits_are_plain_where_people_read_them() {
        let cases =
            [(0.01, "10"), (0.001_575, "1.575"), (-0.000_035, "-0.035"), (0.0, "0"), (1.2, "1200"), (1e-12, "1e-9")];
        for (metres, text) in cases {
            assert_eq!(shifted_digits(metres, MM_DIGITS), text, "{metres} m");
        }
    }

    #[test]
    fn wide_fields_fit_and_read_back() {
        let mut rng = fastrand::Rng::with_seed(42);
        for case in 0..20_000 {
            let value = (rng.f64() - 0.5) * 10_f64.powi(rng.i32(-20..25));
            let text = wide_field(value);
            assert!(text.len() <= 16 && text.contains('.'), "case {case}: {value:e} {text}");
            let error = (text.parse::<f64>().unwrap() - to_mm(value)).abs();
            assert!(error <= 1e-10_f64.max(1e-8 * to_mm(value.abs())), "case {case}: {value:e} m is {text} mm");
            assert!(value.abs() > 1.0 || error <= 1e-10, "case {case}: fine below a metre, but {text}");
        }
        let cases = [(0.01, "10.0"), (-0.000_035, "-0.035"), (0.0, "0.0"), (1e-12, "1.0e-9")];
        for (metres, text) in cases {
            assert_eq!(wide_field(metres), text, "{metres} m");
        }
    }
}
