//! Adaptation: follows slow changes of k1, k3 and c from cycle to cycle by recursive least squares; α stays.
//!
//! Let e = (k1·y, k3·y³, c·|v|^α·sgn v) be the parts of the law as given, r the measured force minus that law's, and θ the relative
//! difference of k1, k3 and c between the running law and the law as given:
//!
//! - S ← λ·S + Σe·eᵀ, z ← λ·z + Σe·r over the looks of a cycle
//! - θ* = (S + μ·tr S·I)⁻¹·z, least squares that leave a coefficient with hardly any force as given. A part that would exceed its
//!   bound is set to the bound, and the others are solved for again
//! - θ ← θ + (θ* − θ), with no part changing by more than [`RATE`]: a straight path, on which the error falls steadily
//!
//! For the first cycles with a law, as many as a run-in takes, the only bound of θ is [`MOST`], so that it finds the specimen's
//! initial condition. From then on the configured bound holds.
//!
//! A cycle counts only if the health monitor is watching, suspects nothing, sees no passing fault and has reported no lasting one.
//! A sudden change is a failure and is not adapted to; a slow change is, up to the bound. The monitor compares with the law as
//! given, so that adaptation hides nothing from it.

use crate::fast_law::Adaptation;
use crate::real::Real;

/// λ: after eleven more cycles the weight of a cycle is a third.
const FORGETTING: f32 = 0.9;
/// μ.
const DAMPING: f32 = 1e-4;
/// Largest change of a part per cycle.
const RATE: f32 = 1e-3;
/// Largest total change of a part.
const MOST: f32 = 0.5;

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

    /// θ*, by S + μ·tr S·I = L·D·Lᵀ, with each `held` part at its given value. `None` without motion, or if a sum exceeds a float.
    fn solution(&self, held: [Option<f32>; 3]) -> Option<[f32; 3]> {
        let [mut aa, mut ab, mut ac, mut bb, mut bc, mut cc] = self.squares;
        let [mut za, mut zb, mut zc] = self.products;
        let trace = aa + bb + cc;
        if !(trace > f32::MIN_POSITIVE && trace < f32::MAX) {
            return None;
        }
        let damping = DAMPING * trace;
        aa += damping;
        bb += damping;
        cc += damping;
        let [held_a, held_b, held_c] = held;
        if let Some(a) = held_a {
            (zb, zc) = (zb - ab * a, zc - ac * a);
            (aa, ab, ac, za) = (trace, 0.0, 0.0, trace * a);
        }
        if let Some(b) = held_b {
            (za, zc) = (za - ab * b, zc - bc * b);
            (bb, ab, bc, zb) = (trace, 0.0, 0.0, trace * b);
        }
        if let Some(c) = held_c {
            (za, zb) = (za - ac * c, zb - bc * c);
            (cc, ac, bc, zc) = (trace, 0.0, 0.0, trace * c);
        }
        let (low_b, low_c) = (ab / aa, ac / aa);
        let second = bb - low_b * ab;
        let mixed = bc - low_c * ab;
        let low = mixed / second;
        let third = cc - low_c * ac - low * mixed;
        let (b, c) = (zb - low_b * za, zc - low_c * za);
        let c = (c - low * b) / third;
        let b = b / second - low * c;
        let a = za / aa - low_b * b - low_c * c;
        (a.is_finite() && b.is_finite() && c.is_finite()).then_some([a, b, c])
    }
}

/// Remaining work of a cycle, done one piece per look.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    None,
    Fold,
    Solve,
}

/// State of the adaptation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Adapter {
    /// Sums of the current cycle, of the cycle that has ended, and of all before with decreasing weight.
    now: Sums,
    ended: Sums,
    past: Sums,
    work: Work,
    /// Parts that are at their bound.
    held: [Option<f32>; 3],
    /// θ of the last reported cycle, θ in force, and θ from the end of this cycle on, one look late.
    reported: [f32; 3],
    followed: [f32; 3],
    next: [f32; 3],
    /// The initial condition found, and the number of cycles in which it was found so far.
    centre: [f32; 3],
    cycles: u32,
    /// A cycle has ended, and its θ is not yet in force.
    due: bool,
}

impl Adapter {
    /// No adaptation: the law as given.
    pub(super) fn new() -> Self {
        Self {
            now: Sums::default(),
            ended: Sums::default(),
            past: Sums::default(),
            work: Work::None,
            held: [None; 3],
            reported: [0.0; 3],
            followed: [0.0; 3],
            next: [0.0; 3],
            centre: [0.0; 3],
            cycles: 0,
            due: false,
        }
    }

    /// The specimen's condition may have changed, as in another block: finds it again, starting from the present θ.
    pub(super) fn restart_search(&mut self) {
        self.past = Sums::default();
        self.work = Work::None;
        self.cycles = 0;
    }

    /// Marks the end of a cycle, which is reported.
    pub(super) fn report(&mut self) {
        self.reported = self.followed;
    }

    /// θ of the last reported cycle.
    pub(super) fn reported(&self) -> Adaptation {
        let [k1, k3, c] = self.reported;
        Adaptation { k1, k3, c }
    }

    /// Force in kN that the running law has in addition to the law as given, whose parts are `parts`.
    pub(super) fn share(&self, [a, b, c]: [f32; 3]) -> f32 {
        let [of_k1, of_k3, of_c] = self.followed;
        of_k1 * a + of_k3 * b + of_c * c
    }

    /// Takes one look: the parts of the law as given, and the measured force minus that law's, kN.
    pub(super) fn add(&mut self, parts: [f32; 3], residual: f32) {
        self.now.add(parts, residual);
    }

    /// Marks the end of a cycle, whether a `steady` one of a block or another: [`Adapter::follow`] is due.
    pub(super) fn cycle(&mut self, steady: bool) {
        self.ended = core::mem::take(&mut self.now);
        self.work = if steady { Work::Fold } else { Work::None };
        self.due = true;
    }

    /// Whether [`Adapter::follow`] is due.
    pub(super) fn is_due(&self) -> bool {
        self.due
    }

    /// The new relative difference of the law.
    pub(super) fn follow(&mut self) -> Adaptation {
        self.due = false;
        self.followed = self.next;
        let [k1, k3, c] = self.followed;
        Adaptation { k1, k3, c }
    }

    /// Whether there is work left.
    pub(super) fn has_work(&self) -> bool {
        self.work != Work::None
    }

    /// Leaves the cycle that has ended out of the adaptation.
    pub(super) fn skip(&mut self) {
        self.work = Work::None;
    }

    /// Does a piece of work, for a law that may differ by `bound` from the condition found in `finding` cycles.
    pub(super) fn work(&mut self, bound: f32, finding: u32) {
        self.work = match self.work {
            Work::Fold => {
                let mut ended = self.ended;
                for (past, ended) in self.past.numbers().zip(ended.numbers()) {
                    *past = FORGETTING * *past + *ended;
                }
                self.held = [None; 3];
                Work::Solve
            }
            Work::Solve => self.solve(bound, finding),
            Work::None => Work::None,
        };
    }

    fn solve(&mut self, bound: f32, finding: u32) -> Work {
        let Some(best) = self.past.solution(self.held) else {
            self.past = Sums::default();
            return Work::None;
        };
        let is_finding = self.cycles < finding;
        // The part that exceeds its bound most, and the bound.
        let mut furthest = (0.0, 0.0);
        let mut place = None;
        let parts = best.iter().zip(&self.centre).zip(&self.held);
        for (index, ((best, centre), held)) in parts.enumerate() {
            let within = if is_finding {
                best.clamped(MOST)
            } else {
                (centre + (best - centre).clamped(bound)).clamped(MOST)
            };
            let beyond = (best - within).abs();
            if held.is_none() && beyond > furthest.0 {
                furthest = (beyond, within);
                place = Some(index);
            }
        }
        if let Some(held) = place.and_then(|place| self.held.get_mut(place)) {
            *held = Some(furthest.1);
            return Work::Solve;
        }
        let mut largest = RATE;
        for (best, next) in best.iter().zip(&self.next) {
            let way = (best - next).abs();
            if way > largest {
                largest = way;
            }
        }
        let part = RATE / largest;
        for (next, best) in self.next.iter_mut().zip(best) {
            *next += part * (best - *next);
        }
        if is_finding {
            self.cycles += 1;
            self.centre = self.next;
        }
        Work::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;

    /// k1, k3 and c of 1, at an amplitude of 1 and α = 0.
    fn parts(look: u16) -> [f32; 3] {
        let (sin, cos) = (libm::sinf, libm::cosf);
        let phase = TAU * f32::from(look) / 32.0 + 0.05;
        let y = sin(phase);
        [y, y * y * y, cos(phase).signum()]
    }

    /// One cycle of a specimen that differs by `truth` from the law with the coefficients `scale`.
    fn cycle(adaptation: &mut Adapter, scale: [f32; 3], truth: [f32; 3]) {
        for look in 0..32 {
            let mut parts = parts(look);
            for (part, scale) in parts.iter_mut().zip(scale) {
                *part *= scale;
            }
            let products = parts.iter().zip(truth).map(|(part, truth)| part * truth);
            adaptation.add(parts, products.sum());
        }
    }

    fn work(adaptation: &mut Adapter, bound: f32, finding: u32) {
        adaptation.cycle(true);
        while adaptation.has_work() {
            adaptation.work(bound, finding);
        }
    }

    fn follow(scale: [f32; 3], truth: [f32; 3], bound: f32, cycles: u32) -> Adapter {
        let mut adaptation = Adapter::new();
        for _ in 0..cycles {
            cycle(&mut adaptation, scale, truth);
            work(&mut adaptation, bound, 0);
        }
        adaptation.follow();
        adaptation
    }

    /// Mean square error of a law with k1, k3 and c of `scale`, adapted by `followed`, for a specimen `truth`.
    fn left(scale: [f32; 3], truth: [f32; 3], followed: [f32; 3]) -> f32 {
        let squares = (0..32).map(|look| {
            let parts = parts(look).into_iter().zip(scale);
            let all = parts.zip(truth.into_iter().zip(followed));
            let error: f32 = all
                .map(|((part, scale), (truth, followed))| part * scale * (truth - followed))
                .sum();
            error * error
        });
        squares.sum::<f32>() / 32.0
    }

    #[test]
    fn it_converges_to_the_truth_on_a_straight_path_at_its_rate() {
        let truth = [-0.05, 0.08, 0.02];
        for (cycles, part) in [(10, 0.125f32), (30, 0.375), (100, 1.0)] {
            let adaptation = follow([1.0; 3], truth, 0.2, cycles);
            for (followed, truth) in adaptation.followed.iter().zip(truth) {
                assert!(
                    (followed - part * truth).abs() < 1e-3,
                    "{cycles}: {followed}"
                );
            }
        }
    }

    /// One coefficient has a thousandth of the others' force: it stays as given, and the others adapt.
    #[test]
    fn a_coefficient_with_hardly_any_force_stays() {
        let [k1, k3, c] = follow([1.0, 1e-3, 1.0], [0.05, 0.5, 0.05], 0.6, 500).followed;
        assert!(k3.abs() < 0.01, "{k3}");
        assert!((k1 - 0.05).abs() < 1e-3 && (c - 0.05).abs() < 1e-3);
    }

    /// k1 and k3 have nearly the same force: where one reaches its bound, the other compensates for it.
    #[test]
    fn the_error_never_rises_on_the_way_to_a_bound() {
        let scale = [1.0, 0.1, 0.3];
        for truth in [[-0.05, 0.5, 0.0], [-0.08, 0.9, -0.05], [0.3, -0.4, 0.2]] {
            let mut adaptation = Adapter::new();
            let mut before = left(scale, truth, [0.0; 3]);
            let first = before;
            for _ in 0..400 {
                cycle(&mut adaptation, scale, truth);
                work(&mut adaptation, 0.1, 0);
                let now = left(scale, truth, adaptation.next);
                assert!(now <= before * 1.0001 + 1e-9, "{now} after {before}");
                before = now;
            }
            assert!(before < 0.9 * first, "{before} of {first}");
            let within = adaptation.next.iter().all(|part| part.abs() <= 0.1001);
            assert!(within, "{:?}", adaptation.next);
        }
    }

    /// With one at its bound, no other values of the remaining two have a smaller error.
    #[test]
    fn the_others_make_the_best_of_one_that_is_held() {
        for (held, truth) in [
            (0, [0.15, -0.02, 0.02]),
            (1, [0.02, 0.15, -0.03]),
            (2, [-0.03, 0.02, -0.2]),
        ] {
            let scale = [1.0, 1.0, 0.3];
            let mut adaptation = Adapter::new();
            for _ in 0..400 {
                cycle(&mut adaptation, scale, truth);
                work(&mut adaptation, 0.1, 0);
            }
            let next = adaptation.next;
            let least = left(scale, truth, next);
            for (index, part) in next.iter().enumerate() {
                assert_eq!(index == held, (part.abs() - 0.1).abs() < 1e-5, "{next:?}");
                for step in [-0.002, 0.002] {
                    let mut beside = next;
                    beside[index] += step;
                    let other = left(scale, truth, beside);
                    assert!(index == held || other > least, "{beside:?} beside {next:?}");
                }
            }
        }
    }

    #[test]
    fn it_goes_no_further_than_its_bound_from_where_it_found_the_specimen() {
        let mut adaptation = Adapter::new();
        let mut go = |truth: f32, finding: u32| {
            for _ in 0..700 {
                cycle(&mut adaptation, [1.0; 3], [truth; 3]);
                work(&mut adaptation, 0.1, finding);
            }
            adaptation.next
        };
        let close = |all: [f32; 3], to: f32| all.iter().all(|one| (one - to).abs() < 1e-3);
        assert!(close(go(-0.2, 700), -0.2));
        assert!(close(go(-0.4, 700), -0.3));
        assert!(close(go(0.4, 700), -0.1));
        // No coefficient is ever halved.
        adaptation.restart_search();
        let mut go = |truth: f32| {
            for _ in 0..700 {
                cycle(&mut adaptation, [1.0; 3], [truth; 3]);
                work(&mut adaptation, 0.1, 1000);
            }
            adaptation.next
        };
        assert!(close(go(-0.9), -MOST));
    }

    #[test]
    fn a_cycle_that_is_skipped_or_not_steady_leaves_nothing() {
        let mut adaptation = Adapter::new();
        for steady in [true, false] {
            cycle(&mut adaptation, [1.0; 3], [0.1; 3]);
            adaptation.cycle(steady);
            assert_eq!(adaptation.has_work(), steady);
            adaptation.skip();
            assert!(!adaptation.has_work());
            assert_eq!(adaptation.past.squares, [0.0; 6]);
        }
        assert_eq!(adaptation.follow(), Adaptation::default());
    }

    #[test]
    fn nan_does_not_stay() {
        let mut adaptation = Adapter::new();
        let (nan, infinity) = (f32::NAN, f32::INFINITY);
        for (part, residual) in [
            (nan, nan),
            (infinity, 1.0),
            (f32::MAX, 1.0),
            (1.0, nan),
            (1.0, infinity),
        ] {
            adaptation.add([part; 3], residual);
            work(&mut adaptation, 0.1, 0);
            assert_eq!(adaptation.next, [0.0; 3]);
        }
        for _ in 0..60 {
            cycle(&mut adaptation, [1.0; 3], [0.05; 3]);
            work(&mut adaptation, 0.1, 0);
        }
        assert!(adaptation.next.iter().all(|one| (one - 0.05).abs() < 1e-3));
    }

    #[test]
    fn the_share_is_the_law_in_force_minus_the_given_law() {
        let mut adaptation = Adapter::new();
        adaptation.followed = [0.1, -0.2, 0.3];
        assert!((adaptation.share([10.0, 1.0, 2.0]) - 1.4).abs() < 1e-6);
    }
}
