//! The per-cycle results of a run, as a table.

use mesh_damper::rig::CycleReport;
use mesh_damper::sine::Programme;
use mesh_damper_output::error::InputError;
use mesh_damper_output::finite::check_document;
use schemars::JsonSchema;
use serde::Serialize;

use super::programme::MOST_BLOCKS;
use crate::commands::say;

/// One cycle, as a row of `cycles.csv` and as JSON. Units are in the names.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct CycleRow {
    /// Number of the block, from 0.
    block: usize,
    /// Number of the cycle, from 0.
    cycle: u32,
    /// Whether the cycle belongs to a ramp between blocks.
    ramp: bool,
    /// Half of the peak-to-peak displacement, mm.
    amplitude_mm: f32,
    /// Mean of the displacement, mm.
    mean_displacement_mm: f32,
    /// Largest force, kN.
    force_max_kn: f32,
    /// Smallest force, kN.
    force_min_kn: f32,
    /// Mean of the force, kN.
    mean_force_kn: f32,
    /// Energy dissipated in the cycle, J.
    energy_j: f32,
    /// Largest stored elastic energy, J.
    elastic_energy_j: f32,
    /// Dynamic stiffness, kN/mm.
    stiffness_kn_per_mm: f32,
    /// Loss factor, dimensionless.
    loss_factor: f32,
    /// Energy that the law dissipates, J.
    model_energy_j: f32,
    /// Dynamic stiffness of the law, kN/mm.
    model_stiffness_kn_per_mm: f32,
    /// Loss factor of the law, dimensionless.
    model_loss_factor: f32,
    /// RMS of the law's error over the RMS of the measured force.
    nrmse: f32,
    /// Adaptation of k1 to the specimen, as a fraction of k1.
    followed_k1: f32,
    /// Adaptation of k3 to the specimen, as a fraction of k3.
    followed_k3: f32,
    /// Adaptation of c to the specimen, as a fraction of c.
    followed_c: f32,
    #[serde(skip)]
    ticks: f32,
}

impl From<&CycleReport> for CycleRow {
    fn from(report: &CycleReport) -> Self {
        let (measured, model) = (&report.measured, &report.model);
        Self {
            block: report.block,
            cycle: report.cycle,
            ramp: report.ramp,
            amplitude_mm: measured.amplitude,
            mean_displacement_mm: measured.mean_displacement,
            force_max_kn: measured.force_max,
            force_min_kn: measured.force_min,
            mean_force_kn: measured.mean_force,
            energy_j: measured.energy,
            elastic_energy_j: measured.elastic_energy,
            stiffness_kn_per_mm: measured.stiffness,
            loss_factor: measured.loss_factor,
            model_energy_j: model.energy,
            model_stiffness_kn_per_mm: model.stiffness,
            model_loss_factor: model.loss_factor,
            nrmse: report.nrmse,
            followed_k1: report.followed.k1,
            followed_k3: report.followed.k3,
            followed_c: report.followed.c,
            ticks: measured.ticks,
        }
    }
}

impl CycleRow {
    /// Whether the cycle is at full amplitude in `block`.
    pub fn is_steady_in(&self, block: usize) -> bool {
        self.block == block && !self.ramp
    }

    /// The adaptation of the law, in words.
    pub fn followed_in_words(&self) -> String {
        format!(
            "The law adapted k1 by {:+.1} %, k3 by {:+.1} % and c by {:+.1} %",
            100.0 * self.followed_k1,
            100.0 * self.followed_k3,
            100.0 * self.followed_c
        )
    }
}

/// The cycles as `cycles.csv`.
pub fn csv_of(cycles: &[CycleRow]) -> Result<Vec<u8>, InputError> {
    check_document("cycles.csv", &cycles)?;
    let failed = |error: String| InputError::new("cycles.csv", error, "report this");
    let mut writer = csv::Writer::from_writer(Vec::new());
    for cycle in cycles {
        writer
            .serialize(cycle)
            .map_err(|error| failed(error.to_string()))?;
    }
    writer
        .into_inner()
        .map_err(|error| failed(error.to_string()))
}

/// Prints the means over each block's steady cycles, for a rig of `tick_rate` Hz. Amplitude and frequency are those of `programme`;
/// without a programme they are the measured ones.
pub fn print_blocks(
    cycles: &[CycleRow],
    programme: Option<&Programme<MOST_BLOCKS>>,
    tick_rate: f64,
) {
    say("    mm      Hz  cycles   K, kN/mm  of law   loss factor  of law   error of law");
    for block in cycles.chunk_by(|a, b| a.block == b.block) {
        let steady: Vec<&CycleRow> = block.iter().filter(|row| !row.ramp).collect();
        if steady.is_empty() {
            continue;
        }
        let mean = |of: fn(&CycleRow) -> f32| {
            steady.iter().map(|row| f64::from(of(row))).sum::<f64>() / steady.len() as f64
        };
        let demanded = programme.and_then(|programme| programme.blocks().nth(steady[0].block));
        let [amplitude, frequency] = match demanded {
            Some(block) => [block.amplitude(), block.to()],
            None => [
                mean(|row| row.amplitude_mm),
                tick_rate / mean(|row| row.ticks),
            ],
        };
        say(&format!(
            "{:6.3} {:7.2} {:7}   {:8.3} {:8.3}   {:10.4} {:8.4}   {:10.2} %",
            amplitude,
            frequency,
            steady.len(),
            mean(|row| row.stiffness_kn_per_mm),
            mean(|row| row.model_stiffness_kn_per_mm),
            mean(|row| row.loss_factor),
            mean(|row| row.model_loss_factor),
            100.0 * mean(|row| row.nrmse),
        ));
    }
}
