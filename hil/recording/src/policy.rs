//! All numbers that decide how a recording is read, for whoever changes or prints them; the code itself reads them in their places.

use crate::averaging::AveragingPolicy;
use crate::clock::ClockPolicy;
use crate::consistency::ConsistencyPolicy;
use crate::cycles::CyclesPolicy;
use crate::faults::FaultsPolicy;
use crate::faults::bridge::BridgePolicy;
use crate::faults::clipping::ClippingPolicy;
use crate::faults::counter::CounterPolicy;
use crate::faults::exchanged::ExchangedPolicy;
use crate::faults::held::HeldPolicy;
use crate::faults::hum::HumPolicy;
use crate::faults::scale::ScalePolicy;
use crate::faults::shift::ShiftPolicy;
use crate::faults::sign::SignPolicy;
use crate::faults::slower::SlowerPolicy;
use crate::faults::spikes::SpikesPolicy;
use crate::faults::velocity::VelocityPolicy;
use crate::harmonic::HarmonicPolicy;
use crate::kinks::KinksPolicy;
use crate::motion::MotionPolicy;
use crate::motion_error::MotionErrorPolicy;
use crate::noise::NoisePolicy;
use crate::noise_floor::NoiseFloorPolicy;
use crate::pink::PinkPolicy;
use crate::resample::ResamplePolicy;
use crate::rest::RestPolicy;
use crate::smoother::SmootherPolicy;
use crate::trajectory::TrajectoryPolicy;
use crate::trajectory::settled::SettledPolicy;
use crate::zero::ZeroPolicy;
use crate::zeros::ZerosPolicy;

crate::policy! {
    /// Channels that were smoothed before they were written.
    averaging: AveragingPolicy,
    /// What stands in for samples that were not measured.
    bridge: BridgePolicy,
    /// Channels at the end of their range.
    clipping: ClippingPolicy,
    /// The clock behind the times.
    clock: ClockPolicy,
    /// Recordings that contradict each other.
    consistency: ConsistencyPolicy,
    /// A displacement whose counter began again.
    counter: CounterPolicy,
    /// Cycles, and blocks of like ones.
    cycles: CyclesPolicy,
    /// Displacement and force in each other's columns.
    exchanged: ExchangedPolicy,
    /// What all searches for channel faults share.
    faults: FaultsPolicy,
    /// Motion that is a sine.
    harmonic: HarmonicPolicy,
    /// Values that were repeated.
    held: HeldPolicy,
    /// Hum of the mains.
    hum: HumPolicy,
    /// Where the velocity jumps.
    kinks: KinksPolicy,
    /// Velocity and acceleration of a measured displacement.
    motion: MotionPolicy,
    /// How far that may be off.
    motion_error: MotionErrorPolicy,
    /// The noise of a channel.
    noise: NoisePolicy,
    /// Noise that neighbouring samples share.
    noise_floor: NoiseFloorPolicy,
    /// Noise that grows towards low frequencies.
    pink: PinkPolicy,
    /// Equal steps of time.
    resample: ResamplePolicy,
    /// Where the displacement stands still.
    rest: RestPolicy,
    /// Units off by a thousand.
    scale: ScalePolicy,
    /// When a recording shows what its specimen remembers.
    settled: SettledPolicy,
    /// A force that is late or early.
    shift: ShiftPolicy,
    /// A force with the wrong sign.
    sign: SignPolicy,
    /// A channel that is slower than the rows.
    slower: SlowerPolicy,
    /// Motions of few samples to the cycle.
    smoother: SmootherPolicy,
    /// Samples that stand out.
    spikes: SpikesPolicy,
    /// A recording made ready for identification.
    trajectory: TrajectoryPolicy,
    /// A measured velocity.
    velocity: VelocityPolicy,
    /// A zero that steps.
    zero: ZeroPolicy,
    /// A zero that is not that of other recordings.
    zeros: ZerosPolicy,
}
