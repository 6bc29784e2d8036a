//! Follows a slow change of k1, k3 and c from cycle to cycle, by recursive least squares; α stays.
//!
//! With e = (k1·y, k3·y³, c·|v|^α·sgn v) of the law as it was given, r the measured force less that law's, and θ by how much
//! the law in force differs from it, parts of k1, k3 and c:
//!
//! - S ← λ·S + Σe·eᵀ, z ← λ·z + Σe·r over the looks of a cycle
//! - θ* = (S + μ·tr S·I)⁻¹·z, least squares that leave be what hardly has a force
//! - θ ← θ + (θ* − θ), by at most [`RATE`], and within the bound of where it was when the run-in was over
//!
//! A cycle counts only where the monitor watches, suspects nothing and has named no fault: what comes at once is a failure and
//! is not followed, and what comes slowly is followed as far as the bound. The monitor judges by the law as it was given,
//! so that following hides nothing from it.

use crate::real::Real;
use crate::tabulated::Followed;

/// λ: a cycle counts a third after eleven more.
const FORGETTING: f32 = 0.9;
/// μ.
const DAMPING: f32 = 1e-4;
/// Most by which a part changes in a cycle.
const RATE: f32 = 1e-3;

/// S, its upper triangle row by row, and z.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    squares: [f32; 6],
    products: [f32; 3],
}

impl Sums {
    fn add(&mut self, [a, b, c]: [f32; 3], residual: f32) {
        let pairs = [a * a, a * b, a * c, b * b, b * c, c * c];
        for (sum, pair) in self.squares.iter_mut().zip(pairs) {
            *sum += pair;
        }
        for (sum, part) in self.products.iter_mut().zip([a, b, c]) {
            *sum += part * residual;
        }
    }

    fn numbers(&mut self) -> impl Iterator<Item = &mut f32> {
        self.squares.iter_mut().chain(&mut self.products)
    }

    /// θ*, by S + μ·tr S·I = L·D·Lᵀ; none where nothing moved, or a sum is beyond a float.
    fn solution(&self) -> Option<[f32; 3]> {
        let [aa, ab, ac, bb, bc, cc] = self.squares;
        let [za, zb, zc] = self.products;
        let trace = aa + bb + cc;
        if !(trace > f32::MIN_POSITIVE && trace < f32::MAX) {
            return None;
        }
        let damping = DAMPING * trace;
        let first = aa + damping;
        let (low_b, low_c) = (ab / first, ac / first);
        let second = bb + damping - low_b * ab;
        let mixed = bc - low_c * ab;
        let low = mixed / second;
        let third = cc + damping - low_c * ac - low * mixed;
        let (b, c) = (zb - low_b * za, zc - low_c * za);
        let c = (c - low * b) / third;
        let b = b / second - low * c;
        let a = za / first - low_b * b - low_c * c;
        (a.is_finite() && b.is_finite() && c.is_finite()).then_some([a, b, c])
    }
}

/// What is left to do of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    None,
    Fold,
    Solve,
}

/// What it has followed, and what it follows by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Adaptation {
    /// Of the cycle under way, of the one that has ended, and of all before, the older the less.
    now: Sums,
    ended: Sums,
    past: Sums,
    work: Work,
    /// θ in force, θ from the end of this cycle on, and θ when the run-in was over.
    followed: [f32; 3],
    next: [f32; 3],
    centre: [f32; 3],
}

impl Adaptation {
    /// The law as it was given.
    pub(super) fn new() -> Self {
        Self {
            now: Sums::default(),
            ended: Sums::default(),
            past: Sums::default(),
            work: Work::None,
            followed: [0.0; 3],
            next: [0.0; 3],
            centre: [0.0; 3],
        }
    }

    /// What the law in force has beyond the law as it was given where that one's parts are `parts`, kN.
    pub(super) fn share(&self, [a, b, c]: [f32; 3]) -> f32 {
        let [of_k1, of_k3, of_c] = self.followed;
        of_k1 * a + of_k3 * b + of_c * c
    }

    /// One look: the parts of the law as it was given, and what is measured beyond it, kN.
    pub(super) fn add(&mut self, parts: [f32; 3], residual: f32) {
        self.now.add(parts, residual);
    }

    /// A cycle has ended, a `steady` one of a block or another. What the law differs by from here on.
    pub(super) fn cycle(&mut self, steady: bool) -> Followed {
        self.ended = core::mem::take(&mut self.now);
        self.work = if steady { Work::Fold } else { Work::None };
        self.followed = self.next;
        self.followed()
    }

    /// θ in force.
    pub(super) fn followed(&self) -> Followed {
        let [k1, k3, c] = self.followed;
        Followed { k1, k3, c }
    }

    /// Whether there is work.
    pub(super) fn has_work(&self) -> bool {
        self.work != Work::None
    }

    /// The cycle that has ended is not to be followed.
    pub(super) fn skip(&mut self) {
        self.work = Work::None;
    }

    /// A piece of work, for a law that may differ by `bound`. While `running_in` that is bound to nothing but its rate.
    pub(super) fn work(&mut self, bound: f32, running_in: bool) {
        self.work = match self.work {
            Work::Fold => {
                let mut ended = self.ended;
                for (past, ended) in self.past.numbers().zip(ended.numbers()) {
                    *past = FORGETTING * *past + *ended;
                }
                Work::Solve
            }
            Work::Solve => {
                self.solve(bound, running_in);
                Work::None
            }
            Work::None => Work::None,
        };
    }

    fn solve(&mut self, bound: f32, running_in: bool) {
        let Some(best) = self.past.solution() else {
            self.past = Sums::default();
            return;
        };
        let all = self.next.iter_mut().zip(&mut self.centre).zip(best);
        for ((next, centre), best) in all {
            *next += (best - *next).confined(RATE);
            if running_in {
                *centre = *next;
            } else {
                *next = *centre + (*next - *centre).confined(bound);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;

    /// k1, k3 and c of one, at an amplitude of one and α = 0.
    fn parts(look: u16) -> [f32; 3] {
        let (sin, cos) = (libm::sinf, libm::cosf);
        let phase = TAU * f32::from(look) / 64.0 + 0.05;
        let y = sin(phase);
        [y, y * y * y, cos(phase).signum()]
    }

    /// One cycle of a specimen that differs by `truth` from the law, whose coefficients are `scale`.
    fn cycle(adaptation: &mut Adaptation, scale: [f32; 3], truth: [f32; 3]) {
        for look in 0..64 {
            let mut parts = parts(look);
            for (part, scale) in parts.iter_mut().zip(scale) {
                *part *= scale;
            }
            let products = parts.iter().zip(truth).map(|(part, truth)| part * truth);
            adaptation.add(parts, products.sum());
        }
    }

    fn follow(scale: [f32; 3], truth: [f32; 3], bound: f32, cycles: u32) -> Adaptation {
        let mut adaptation = Adaptation::new();
        for _ in 0..cycles {
            cycle(&mut adaptation, scale, truth);
            adaptation.cycle(true);
            while adaptation.has_work() {
                adaptation.work(bound, false);
            }
        }
        adaptation.cycle(true);
        adaptation
    }

    #[test]
    fn it_comes_to_the_truth_at_its_rate() {
        let truth = [-0.05, 0.08, 0.02];
        for (cycles, come_to) in [(10, 0.01f32), (30, 0.03), (100, 0.1)] {
            let adaptation = follow([1.0; 3], truth, 0.2, cycles);
            for (followed, truth) in adaptation.followed.iter().zip(truth) {
                let expected = truth.confined(come_to);
                assert!((followed - expected).abs() < 1e-3, "{cycles}: {followed}");
            }
        }
    }

    /// One coefficient has a thousandth of the others' force: it stays, and the others are followed.
    #[test]
    fn what_hardly_has_a_force_is_left_be() {
        let [k1, k3, c] = follow([1.0, 1e-3, 1.0], [0.05, 0.5, 0.05], 0.6, 500).followed;
        assert!(k3.abs() < 0.01, "{k3}");
        assert!((k1 - 0.05).abs() < 1e-3 && (c - 0.05).abs() < 1e-3);
    }

    #[test]
    fn it_goes_no_further_than_its_bound_from_where_the_run_in_ended() {
        let mut adaptation = Adaptation::new();
        let mut go = |truth: f32, running_in: bool| {
            for _ in 0..300 {
                cycle(&mut adaptation, [1.0; 3], [truth; 3]);
                adaptation.cycle(true);
                while adaptation.has_work() {
                    adaptation.work(0.1, running_in);
                }
            }
            adaptation.next
        };
        let close = |all: [f32; 3], to: f32| all.iter().all(|one| (one - to).abs() < 1e-3);
        assert!(close(go(-0.2, true), -0.2));
        assert!(close(go(-0.5, false), -0.3));
        assert!(close(go(0.5, false), -0.1));
    }

    #[test]
    fn a_cycle_that_is_skipped_or_not_steady_leaves_nothing() {
        let mut adaptation = Adaptation::new();
        for steady in [true, false] {
            cycle(&mut adaptation, [1.0; 3], [0.1; 3]);
            adaptation.cycle(steady);
            assert_eq!(adaptation.has_work(), steady);
            adaptation.skip();
            assert!(!adaptation.has_work());
            assert_eq!(adaptation.past.squares, [0.0; 6]);
        }
        assert_eq!(adaptation.cycle(true), Followed::default());
    }

    #[test]
    fn what_is_no_number_does_not_stay() {
        let mut adaptation = Adaptation::new();
        for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
            adaptation.add([bad; 3], bad);
            adaptation.cycle(true);
            while adaptation.has_work() {
                adaptation.work(0.1, false);
            }
        }
        for _ in 0..60 {
            cycle(&mut adaptation, [1.0; 3], [0.05; 3]);
            adaptation.cycle(true);
            while adaptation.has_work() {
                adaptation.work(0.1, false);
            }
        }
        assert!(adaptation.next.iter().all(|one| (one - 0.05).abs() < 1e-3));
    }

    #[test]
    fn the_share_is_what_the_law_in_force_has_beyond_the_given() {
        let mut adaptation = Adaptation::new();
        adaptation.followed = [0.1, -0.2, 0.3];
        assert!((adaptation.share([10.0, 1.0, 2.0]) - 1.4).abs() < 1e-6);
    }
}
