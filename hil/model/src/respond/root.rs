//! The root of a function between two points at which it has opposite signs.

/// Most evaluations. Halving alone takes fewer to get from the largest velocity to the smallest that differs from 0.
const MOST: usize = 120;

/// A point and the function there.
pub(super) type Point = (f64, f64);

/// A root of `function` between `a` and `b`, at which it has opposite signs, to the last bits or until its magnitude is at most
/// `near`. If the function jumps from one sign to the other, the place of the jump.
///
/// Chandrupatla (1997), Advances in Engineering Software 28, 145–149: inverse quadratic interpolation where that is safe, halving
/// elsewhere. A force with an infinite slope takes halvings, any other a few steps.
pub(super) fn root(mut function: impl FnMut(f64) -> f64, a: Point, b: Point, near: f64) -> f64 {
    let (mut one, mut two) = (a, b);
    // The first step is a secant: the bracket of a smooth force is narrow.
    let mut part = (one.1 / (one.1 - two.1)).clamp(0.01, 0.99);
    for _ in 0..MOST {
        let x = one.0 + part * (two.0 - one.0);
        let new = (x, function(x));
        let three;
        if (new.1 > 0.0) == (one.1 > 0.0) {
            three = one;
        } else {
            three = two;
            two = one;
        }
        one = new;
        let best = if one.1.abs() < two.1.abs() { one } else { two };
        let tolerance = 2.0 * f64::EPSILON * best.0.abs() + f64::MIN_POSITIVE;
        let least = tolerance / (two.0 - one.0).abs();
        if least > 0.5 || best.1.abs() <= near {
            return best.0;
        }
        let xi = (one.0 - two.0) / (three.0 - two.0);
        let phi = (one.1 - two.1) / (three.1 - two.1);
        part = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            one.1 / (two.1 - one.1) * (three.1 / (two.1 - three.1))
                + (three.0 - one.0) / (two.0 - one.0)
                    * (one.1 / (three.1 - one.1))
                    * (two.1 / (three.1 - two.1))
        } else {
            0.5
        }
        .clamp(least, 1.0 - least);
    }
    if one.1.abs() < two.1.abs() {
        one.0
    } else {
        two.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(function: impl Fn(f64) -> f64 + Copy, low: f64, high: f64) -> f64 {
        root(function, (low, function(low)), (high, function(high)), 0.0)
    }

    #[test]
    fn roots_are_found_to_the_last_bits() {
        assert!((found(|x| x * x - 2.0, 0.0, 2.0) - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!((found(|x| x.cos() - x, 0.0, 1.0) - 0.739_085_133_215_160_6).abs() < 1e-15);
        // An infinite slope at the root.
        let steep = |x: f64| (x - 1e-3).abs().powf(0.1) * (x - 1e-3).signum();
        assert!((found(steep, -1.0, 2.0) - 1e-3).abs() < 1e-15);
    }

    #[test]
    fn a_jump_is_found_where_it_is() {
        let jump = |x: f64| x + if x > 0.3 { 1.0 } else { -1.0 };
        assert!((found(jump, -5.0, 5.0) - 0.3).abs() < 1e-14);
    }
}
