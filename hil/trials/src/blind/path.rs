//! Motions other than blocks of sines, with their exact velocity and acceleration.

use std::f64::consts::{PI, TAU};

use mesh_damper_reference::protocol::MotionSample;
use rand::{Rng, RngExt};
use serde::Serialize;

use super::families::log_uniform;

/// The kind of motion of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Band-limited noise.
    Random,
    /// Band-limited noise that rises quickly and decays, as an earthquake.
    Quake,
    /// Bursts of band-limited noise with pauses, in which the displacement stands still.
    Field,
    /// Odd multiples of one frequency, all with the same size.
    Multisine,
    /// A sine with a little noise added.
    SineOnRandom,
    /// A sine with a varying amplitude.
    Modulated,
    /// Two sines of nearly equal frequency.
    Beat,
    /// One sine with a rising frequency.
    Chirp,
    /// One sine.
    Sine,
    /// One slow sine.
    QuasiStatic,
    /// Smooth steps to random places with long holds.
    Steps,
    /// Constant speeds with short holds between them.
    Trapezoid,
    /// Constant speeds, back and forth.
    Triangle,
    /// A staircase up and down.
    Staircase,
}

impl Kind {
    /// All kinds, in the order in which seeds take turns.
    pub const ALL: [Self; 14] = [
        Self::Random,
        Self::Quake,
        Self::Field,
        Self::Multisine,
        Self::SineOnRandom,
        Self::Modulated,
        Self::Beat,
        Self::Chirp,
        Self::Sine,
        Self::QuasiStatic,
        Self::Steps,
        Self::Trapezoid,
        Self::Triangle,
        Self::Staircase,
    ];
}

/// a·sin(ω·t + ½·ω̇·t² + φ)
#[derive(Clone, Copy, Debug)]
struct Tone {
    amplitude: f64,
    /// rad/s
    turn: f64,
    /// rad/s²
    rise: f64,
    phase: f64,
}

/// A move from one place to another in a given time, with a hold there.
#[derive(Clone, Copy, Debug)]
struct Move {
    start: f64,
    length: f64,
    from: f64,
    to: f64,
    is_smooth: bool,
}

/// A factor that changes smoothly from one value to another, and stays there.
#[derive(Clone, Copy, Debug)]
struct Gate {
    start: f64,
    length: f64,
    from: f64,
    to: f64,
}

/// A displacement over time: tones under gates, and additional moves.
#[derive(Clone, Debug)]
pub struct Path {
    tones: Vec<Tone>,
    gates: Vec<Gate>,
    moves: Vec<Move>,
    /// s
    pub duration: f64,
}

impl Path {
    /// A motion of `kind` with a largest displacement of about `largest` mm.
    pub fn draw(kind: Kind, largest: f64, rng: &mut impl Rng) -> Self {
        let mut path = Self {
            tones: Vec::new(),
            gates: Vec::new(),
            moves: Vec::new(),
            duration: rng.random_range(20.0..40.0),
        };
        let end = path.duration;
        match kind {
            Kind::Random => {
                path.noise(0.3, rng.random_range(6.0..15.0), 60, rng);
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::Quake => {
                path.noise(0.3, rng.random_range(4.0..10.0), 60, rng);
                path.gate(0.5, rng.random_range(3.0..8.0), 1.0);
                let from = rng.random_range(0.3..0.5) * end;
                path.gate(from, 0.6 * (end - from), rng.random_range(0.05..0.3));
            }
            Kind::Field => {
                path.noise(0.3, rng.random_range(4.0..10.0), 60, rng);
                let mut at = 0.0;
                while at < end {
                    path.gate(at, 0.5, rng.random_range(0.4..1.0));
                    at += rng.random_range(2.0..6.0);
                    path.gate(at, 0.5, 0.0);
                    at += 0.5;
                    let place = path.moves.last().map_or(0.0, |last| last.to);
                    let to = largest * rng.random_range(-0.3..0.3);
                    path.go(at, 0.4, place, to, true);
                    at += rng.random_range(1.0..4.0);
                }
            }
            Kind::Multisine => {
                let first = rng.random_range(0.2..0.6);
                for number in 0..10 {
                    let frequency = first * f64::from(2 * number + 1);
                    path.tone(1.0, frequency, rng.random_range(0.0..TAU));
                }
                path.gate(0.0, 1.0 / first, 1.0);
            }
            Kind::SineOnRandom => {
                path.noise(0.3, 12.0, 40, rng);
                for tone in &mut path.tones {
                    tone.amplitude *= 0.3;
                }
                path.tone(4.0, rng.random_range(1.0..5.0), 0.0);
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::Modulated => {
                let (carrier, swing) = (rng.random_range(1.0..5.0), rng.random_range(0.05..0.3));
                path.tone(1.0, carrier, 0.0);
                let depth = rng.random_range(0.2..0.4);
                path.tone(depth, carrier + swing, 0.0);
                path.tone(depth, carrier - swing, 0.0);
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::Beat => {
                let frequency = rng.random_range(1.0..5.0);
                path.tone(1.0, frequency, 0.0);
                path.tone(
                    rng.random_range(0.4..0.8),
                    frequency * rng.random_range(1.05..1.3),
                    0.0,
                );
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::Chirp => {
                let (from, to) = (rng.random_range(0.3..1.0), rng.random_range(6.0..12.0));
                path.tones.push(Tone {
                    amplitude: 1.0,
                    turn: TAU * from,
                    rise: TAU * (to - from) / end,
                    phase: 0.0,
                });
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::Sine => {
                path.tone(1.0, rng.random_range(0.8..4.0), 0.0);
                path.gate(0.0, 1.0, 1.0);
            }
            Kind::QuasiStatic => {
                let frequency = log_uniform(0.01, 0.05, rng);
                path.duration = rng.random_range(4.0..7.0) / frequency;
                path.tone(1.0, frequency, 0.0);
                path.gate(0.0, 1.0 / frequency, 1.0);
            }
            Kind::Steps => path.walk(largest, rng, |rng| {
                (rng.random_range(0.1..0.4), rng.random_range(1.0..3.0), true)
            }),
            Kind::Trapezoid => path.sweep(largest, rng, |rng| rng.random_range(0.2..0.8)),
            Kind::Triangle => path.sweep(largest, rng, |_| 0.0),
            Kind::Staircase => {
                let (mut at, mut place, mut step) = (0.5, 0.0, 0.25 * largest);
                while at < end {
                    let to: f64 = place + step;
                    path.go(at, 0.2, place, to, true);
                    place = to;
                    if (place + step).abs() > largest {
                        step = -step;
                    }
                    at += rng.random_range(0.6..1.5);
                }
            }
        }
        path.scale_to(largest);
        path
    }

    /// Tones of random phase, equally many in every octave, with similar speeds.
    fn noise(&mut self, low: f64, high: f64, count: usize, rng: &mut impl Rng) {
        for _ in 0..count {
            let frequency = log_uniform(low, high, rng);
            self.tone(
                1.0 / frequency.max(1.0),
                frequency,
                rng.random_range(0.0..TAU),
            );
        }
    }

    fn tone(&mut self, amplitude: f64, frequency: f64, phase: f64) {
        self.tones.push(Tone {
            amplitude,
            turn: TAU * frequency,
            rise: 0.0,
            phase,
        });
    }

    fn gate(&mut self, start: f64, length: f64, to: f64) {
        let from = self.gates.last().map_or(0.0, |gate| gate.to);
        self.gates.push(Gate {
            start,
            length,
            from,
            to,
        });
    }

    fn go(&mut self, start: f64, length: f64, from: f64, to: f64, is_smooth: bool) {
        self.moves.push(Move {
            start,
            length,
            from,
            to,
            is_smooth,
        });
    }

    /// To random places: the time of a move, of the hold after it, and whether it is smooth.
    fn walk<R: Rng>(
        &mut self,
        largest: f64,
        rng: &mut R,
        mut next: impl FnMut(&mut R) -> (f64, f64, bool),
    ) {
        let (mut at, mut place) = (0.5, 0.0);
        while at < self.duration {
            let to = largest * rng.random_range(-1.0..1.0);
            let (length, hold, is_smooth) = next(rng);
            self.go(at, length, place, to, is_smooth);
            place = to;
            at += length + hold;
        }
    }

    /// Back and forth at one speed each time, with holds at both ends.
    fn sweep<R: Rng>(&mut self, largest: f64, rng: &mut R, mut hold: impl FnMut(&mut R) -> f64) {
        let (mut at, mut place, mut way) = (0.0, 0.0, 1.0);
        while at < self.duration {
            let to = way * largest * rng.random_range(0.3..1.0);
            let length = rng.random_range(0.5..2.0);
            self.go(at, length, place, to, false);
            place = to;
            way = -way;
            at += length + hold(rng);
        }
    }

    /// Scales tones to the requested size; moves have it already.
    fn scale_to(&mut self, largest: f64) {
        if self.tones.is_empty() {
            return;
        }
        let moves = std::mem::take(&mut self.moves);
        let most = (0..)
            .map(|index| f64::from(index) * 0.01)
            .take_while(|time| *time < self.duration)
            .map(|time| self.at(time).displacement.abs())
            .fold(0.0, f64::max);
        self.moves = moves;
        for tone in &mut self.tones {
            tone.amplitude *= largest / most;
        }
    }

    /// Displacement mm, velocity mm/s and acceleration mm/s² at `time` s.
    pub fn at(&self, time: f64) -> MotionSample {
        let mut tones = [0.0; 3];
        for tone in &self.tones {
            let turn = tone.turn + tone.rise * time;
            let angle = tone.phase + (tone.turn + 0.5 * tone.rise * time) * time;
            let (sin, cos) = angle.sin_cos();
            tones[0] += tone.amplitude * sin;
            tones[1] += tone.amplitude * turn * cos;
            tones[2] += tone.amplitude * (tone.rise * cos - turn * turn * sin);
        }
        let gate = self.gates.iter().rev().find(|gate| time >= gate.start);
        let first = self
            .gates
            .first()
            .map_or([1.0, 0.0, 0.0], |gate| [gate.from, 0.0, 0.0]);
        let gate = gate.map_or(first, |gate| {
            along(time - gate.start, gate.length, gate.from, gate.to, true)
        });
        let step = self.moves.iter().rev().find(|step| time >= step.start);
        let step = step.map_or([0.0; 3], |step| {
            along(
                time - step.start,
                step.length,
                step.from,
                step.to,
                step.is_smooth,
            )
        });
        let [g, dg, ddg] = gate;
        MotionSample {
            time,
            displacement: g * tones[0] + step[0],
            velocity: dg * tones[0] + g * tones[1] + step[1],
            acceleration: ddg * tones[0] + 2.0 * dg * tones[1] + g * tones[2] + step[2],
        }
    }
}

/// The transition from one value to another, with both derivatives: along half a wave of a cosine, or at a constant speed.
fn along(since: f64, length: f64, from: f64, to: f64, is_smooth: bool) -> [f64; 3] {
    if since >= length {
        return [to, 0.0, 0.0];
    }
    let way = to - from;
    if !is_smooth {
        return [from + way * since / length, way / length, 0.0];
    }
    let turn = PI / length;
    let (sin, cos) = (turn * since).sin_cos();
    [
        from + 0.5 * way * (1.0 - cos),
        0.5 * way * turn * sin,
        0.5 * way * turn * turn * cos,
    ]
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// By differences, except where the speed jumps.
    #[test]
    fn velocity_and_acceleration_are_those_of_the_displacement() {
        for (seed, kind) in (0..).zip(Kind::ALL) {
            let path = Path::draw(kind, 0.2, &mut ChaCha8Rng::seed_from_u64(seed));
            let step = 1e-5;
            let mut jumps = 0;
            for index in 1..400 {
                let time = path.duration * f64::from(index) / 400.3;
                let [before, now, after] = [-step, 0.0, step].map(|d| path.at(time + d));
                let velocity = (after.displacement - before.displacement) / (2.0 * step);
                let acceleration = (after.velocity - before.velocity) / (2.0 * step);
                let near = (velocity - now.velocity).abs() < 1e-5 * (1.0 + velocity.abs())
                    && (acceleration - now.acceleration).abs() < 1e-4 * (1.0 + acceleration.abs());
                jumps += usize::from(!near);
            }
            assert!(jumps <= 2, "{kind:?}: {jumps}");
            let largest =
                (0..4000).map(|i| path.at(path.duration * f64::from(i) / 4000.0).displacement);
            let largest = largest.fold(0.0_f64, |most, y| most.max(y.abs()));
            assert!((0.1..0.4).contains(&largest), "{kind:?}: {largest} mm");
        }
    }
}
