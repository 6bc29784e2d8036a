//! The whole way once, without a recording at hand: a specimen with an effect that nobody declared is tested on the
//! simulated rig, the recording is traced, and the rig runs again with the augmented model.
//!
//! ```
//! use mesh_damper_demo::{DemoError, demo};
//!
//! let demo = demo(3, &|step| println!("{step}"))?;
//! assert!(demo.is_named() && demo.is_nearer());
//! # Ok::<(), DemoError>(())
//! ```
#![forbid(unsafe_code)]

use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_identify::trace::{Trace, TraceError, trace};
use mesh_damper_model::{LawNode, MAX_EFFECTS, Model, ModelError};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::{self, PROTOCOL};
use mesh_damper_rig::specimen::{DrawnEffect, Specimen, draw};
use mesh_damper_rig::{RigRun, RigSetup, SetupError, TICK_RATE, run_rig};

/// Blocks that a programme of the demo holds.
const CAPACITY: usize = 16;
/// Whole cycles in which the generator goes from one block to the next.
const RAMP_CYCLES: u32 = 1;
/// The test that the laws are compared on in the loop: other amplitudes and frequencies than the one that was fitted, and
/// long enough for what changes with cycles or temperature.
const CHECK: [protocol::TestBlock; 4] = [
    protocol::TestBlock {
        amplitude: 0.12,
        frequency: 3.0,
        cycles: 12,
    },
    protocol::TestBlock {
        amplitude: 0.18,
        frequency: 1.5,
        cycles: 6,
    },
    protocol::TestBlock {
        amplitude: 0.08,
        frequency: 7.0,
        cycles: 20,
    },
    protocol::TestBlock {
        amplitude: 0.15,
        frequency: 4.0,
        cycles: 16,
    },
];

/// Why a demo could not be made.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// A setup was refused.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A law was refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A programme was refused.
    #[error(transparent)]
    Programme(#[from] ConfigError),
    /// The rig's recording was refused.
    #[error(transparent)]
    Recording(#[from] InputError),
    /// The recording could not be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The rig stopped before its programme's end.
    #[error("the rig tripped after {time:.2} s: {fault}")]
    Stopped {
        /// s since the start.
        time: f64,
        /// Why.
        fault: String,
    },
}

/// What a demo did.
#[derive(Clone, Debug)]
pub struct Demo {
    /// The effect that the specimen hid.
    pub drawn: DrawnEffect,
    /// The rig's recording, which was traced.
    pub recording: Recording,
    /// What the trace found.
    pub trace: Trace,
    /// The loop with the mixed damping law alone, on a test that was not fitted.
    pub before: RigRun,
    /// The loop with the law that the trace ended in, on the same test.
    pub after: RigRun,
}

impl Demo {
    /// Whether the effect that was hidden is among those found.
    pub fn is_named(&self) -> bool {
        let hidden = self.drawn.effect.family();
        self.trace
            .result
            .effects
            .iter()
            .any(|effect| effect.family == hidden)
    }

    /// Whether the law that the trace ended in is nearer the specimen in the loop.
    pub fn is_nearer(&self) -> bool {
        loop_error(&self.after) < loop_error(&self.before)
    }
}

/// RMS of the force that the rig's law gave beside the specimen, less the force measured there, over the RMS of the latter;
/// ramps included.
pub fn loop_error(run: &RigRun) -> f64 {
    let samples = &run.samples;
    let (error, force) = samples.model_force.iter().zip(&samples.force).fold(
        (0.0, 0.0),
        |(error, force), (model, measured)| {
            (
                error + (model - measured).powi(2),
                force + measured * measured,
            )
        },
    );
    (error / force).sqrt()
}

/// A test of the simulated rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Test {
    /// Eight blocks over amplitude and frequency. The demo traces it.
    Protocol,
    /// Four blocks of other amplitudes and frequencies, with other noise. The demo compares the laws on it.
    Check,
}

impl Test {
    fn blocks(self) -> &'static [protocol::TestBlock] {
        match self {
            Self::Protocol => &PROTOCOL,
            Self::Check => &CHECK,
        }
    }

    /// Other noise than in the recording that was fitted.
    fn noise(self, seed: u64) -> u64 {
        match self {
            Self::Protocol => seed,
            Self::Check => !seed,
        }
    }
}

/// The recording of a `test` of the specimen that `seed` draws, under the published law, and what that specimen hides.
///
/// # Errors
/// A part of the rig that refused what it was given, or a stop of the rig.
pub fn record(seed: u64, test: Test) -> Result<(DrawnEffect, Recording), DemoError> {
    let (specimen, drawn) = draw(seed);
    let table = Specimen::of_density(drawn.density, 0.1).coefficients();
    let published = Model {
        law: vec![LawNode {
            amplitude: 0.0,
            k1: table.k1,
            k3: table.k3,
            c: table.c,
            alpha: table.alpha,
        }],
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    };
    let recording = run(&specimen, &published, test, seed)?
        .recording(format!("rig test, seed {seed}"))?
        .with_comment(format!(
            "specimen: MMD 22x12x15 mm, density_g_cm3 = {:.1}",
            drawn.density
        ))
        .with_comment(format!("rig: simulated, seed {seed}"));
    Ok((drawn, recording))
}

/// Runs the demo with the specimen that `seed` draws. `progress` is told what is being done.
///
/// # Errors
/// A part of the way that refused what the part before it gave.
pub fn demo(seed: u64, progress: &(dyn Fn(&str) + Sync)) -> Result<Demo, DemoError> {
    progress("running the rig with the published law");
    let (drawn, recording) = record(seed, Test::Protocol)?;
    let (specimen, _) = draw(seed);
    let trace = trace(std::slice::from_ref(&recording), &[], progress)?;
    progress("running the rig again with the mixed damping law alone");
    let before = run(&specimen, &trace.baseline, Test::Check, seed)?;
    progress("running the rig again with the augmented model");
    let after = run(&specimen, &trace.model, Test::Check, seed)?;
    Ok(Demo {
        drawn,
        recording,
        trace,
        before,
        after,
    })
}

fn run(specimen: &Specimen, model: &Model, test: Test, seed: u64) -> Result<RigRun, DemoError> {
    let blocks = test.blocks();
    let mut programme = Programme::<CAPACITY>::new(TICK_RATE, RAMP_CYCLES)?;
    let mut block_laws = Vec::new();
    for block in blocks {
        programme = programme.with(Block::sine(block.amplitude, block.frequency, block.cycles)?)?;
        block_laws.push(model.law_at(block.amplitude)?);
    }
    let law = model.augmented::<f32>(blocks[0].amplitude, 1.0 / TICK_RATE)?;
    let mut setup: RigSetup<Specimen, CAPACITY, MAX_EFFECTS> =
        RigSetup::new(specimen.at_rest(), law, programme, test.noise(seed));
    setup.block_laws = block_laws;
    let run = run_rig(setup, |_| ())?;
    match run.faults.first() {
        Some((time, fault)) => Err(DemoError::Stopped {
            time: *time,
            fault: format!("{fault:?}"),
        }),
        None => Ok(run),
    }
}
