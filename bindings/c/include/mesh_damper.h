/* mesh-damper for C: the law of a metal mesh damper with its effects, per-cycle results, a sine generator, a damper emulation and a rig.
 *
 * Generated from bindings/c of mesh-damper: change that instead. docs/c.md is its page.
 *
 * Units are mm, s, kN and J = kN*mm. All memory is the caller's. No function is called from two contexts at once with the same
 * memory. A function that runs every tick fails only on memory that was never initialised, and its result is finite for every finite input.
 */

#ifndef MESH_DAMPER_H
#define MESH_DAMPER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The sizes of this target. */
#if UINTPTR_MAX == 0xFFFFFFFFu
#define MD_POINTERS_OF_32_BITS
#elif UINTPTR_MAX == 0xFFFFFFFFFFFFFFFFu
#define MD_POINTERS_OF_64_BITS
#else
#error "mesh_damper.h: a target's pointers have 32 or 64 bits"
#endif

/* For another compiler, define it before this header. */
#ifndef MD_ALIGNED
#define MD_ALIGNED(bytes) __attribute__((aligned(bytes)))
#endif

// Findings of a rig's monitor. The numbers are those of the link. A later version may have more of them.
enum md_health
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Stiffness falls, and energy with it.
  MD_HEALTH_WIRE_BREAKAGE = 0,
  // Energy falls, stiffness stays.
  MD_HEALTH_FRICTION_WEAR = 1,
  // A gap opens: force is missing near zero displacement.
  MD_HEALTH_LOOSENING = 2,
  // The mean force changes at once.
  MD_HEALTH_PRELOAD_SHIFT = 3,
  // A change that no other cause explains, or one that a newer version names.
  MD_HEALTH_UNEXPLAINED = 4,
  // Settled after the start by more than the size of a fault.
  MD_HEALTH_RUN_IN = 5,
  // Changed with the temperature by more than the size of a fault.
  MD_HEALTH_TEMPERATURE = 6,
  // The displacement channel repeats one value while its quantity moves.
  MD_HEALTH_DISPLACEMENT_STUCK = 7,
  // The force channel repeats one value while its quantity moves.
  MD_HEALTH_FORCE_STUCK = 8,
  // The displacement channel shows 0 V while its quantity moves; that of the force also if it no longer follows the motion.
  MD_HEALTH_DISPLACEMENT_DROPPED_OUT = 9,
  // The force channel shows 0 V while its quantity moves; that of the force also if it no longer follows the motion.
  MD_HEALTH_FORCE_DROPPED_OUT = 10,
  // The displacement channel stays at an extreme value until its quantity returns, or is at an end of the converter's range.
  MD_HEALTH_DISPLACEMENT_CLIPPED = 11,
  // The force channel stays at an extreme value until its quantity returns, or is at an end of the converter's range.
  MD_HEALTH_FORCE_CLIPPED = 12,
  // The displacement channel has single samples that are outliers in both directions.
  MD_HEALTH_DISPLACEMENT_SPIKING = 13,
  // The force channel has single samples that are outliers in both directions.
  MD_HEALTH_FORCE_SPIKING = 14,
  // The displacement channel's zero moves, bit by bit.
  MD_HEALTH_DISPLACEMENT_DRIFTING = 15,
  // The force channel's zero moves, bit by bit.
  MD_HEALTH_FORCE_DRIFTING = 16,
  // The actuator does not reach the demanded motion, and the shape of its motion differs.
  MD_HEALTH_ACTUATOR_SATURATED = 17,
  // The actuator's motion has the demanded shape, but is late or of another size.
  MD_HEALTH_ACTUATOR_LAGGING = 18,
  // The actuator stands still.
  MD_HEALTH_ACTUATOR_DEAD = 19,
  // Energy rises, stiffness stays: the specimen galls or seizes.
  MD_HEALTH_FRICTION_RISE = 20,
  // Stiffness rises, with energy or without.
  MD_HEALTH_STIFFENING = 21,
  // The displacement channel shows more or less than before for the same quantity.
  MD_HEALTH_DISPLACEMENT_GAIN = 22,
  // The force channel shows more or less than before for the same quantity.
  MD_HEALTH_FORCE_GAIN = 23,
  // The displacement channel has more noise or hum than the monitor learned.
  MD_HEALTH_DISPLACEMENT_NOISY = 24,
  // The force channel has more noise or hum than the monitor learned.
  MD_HEALTH_FORCE_NOISY = 25,
  // The force does not follow the motion, and never did: there is no specimen.
  MD_HEALTH_SPECIMEN_ABSENT = 26,
  // The displacement channel has the opposite sign.
  MD_HEALTH_DISPLACEMENT_REVERSED = 27,
  // The force channel has the opposite sign.
  MD_HEALTH_FORCE_REVERSED = 28,
  // The specimen differs much from the law from the start.
  MD_HEALTH_LAW_MISMATCH = 29,
  // The measured temperature is implausible: not finite, out of range, or changing faster than a specimen warms.
  MD_HEALTH_TEMPERATURE_IMPLAUSIBLE = 30,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_health md_health;
#else
typedef int32_t md_health;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Largest number of effects in a law.
#define MD_EFFECTS 8

// Largest number of control inputs of a damper.
#define MD_CONTROLS 4

// Length of an identity, bytes.
#define MD_IDENTITY 8

// Bytes of `md_law`, with room for effects to come.
#define MD_LAW_SIZE 8192

// Alignment of `md_law`, bytes.
#define MD_LAW_ALIGN 8

// Largest length of a model's name with its NUL, bytes.
#define MD_NAME 33

// Bytes of `md_cycles`.
#define MD_CYCLES_SIZE 144

// Alignment of `md_cycles`, bytes.
#define MD_CYCLES_ALIGN 8

// Bytes of `md_crossings`.
#define MD_CROSSINGS_SIZE 200

// Alignment of `md_crossings`, bytes.
#define MD_CROSSINGS_ALIGN 8

// Largest number of blocks in a programme.
#define MD_BLOCKS 8

#if defined(MD_POINTERS_OF_32_BITS)
// Bytes of `md_sine`.
#define MD_SINE_SIZE 1488
#endif

#if defined(MD_POINTERS_OF_64_BITS)
// Bytes of `md_sine`.
#define MD_SINE_SIZE 1520
#endif

// Alignment of `md_sine`, bytes.
#define MD_SINE_ALIGN 16

// Bytes of `md_scale`.
#define MD_SCALE_SIZE 16

// Alignment of `md_scale`, bytes.
#define MD_SCALE_ALIGN 4

#if defined(MD_POINTERS_OF_32_BITS)
// Bytes of `md_emulation`.
#define MD_EMULATION_SIZE 584
#endif

#if defined(MD_POINTERS_OF_64_BITS)
// Bytes of `md_emulation`.
#define MD_EMULATION_SIZE 584
#endif

// Alignment of `md_emulation`, bytes.
#define MD_EMULATION_ALIGN 8

#if defined(MD_POINTERS_OF_32_BITS)
// Bytes of `md_rig`.
#define MD_RIG_SIZE 4352
#endif

#if defined(MD_POINTERS_OF_64_BITS)
// Bytes of `md_rig`.
#define MD_RIG_SIZE 4512
#endif

// Alignment of `md_rig`, bytes.
#define MD_RIG_ALIGN 16

// Error codes of the calls. The numbers do not change.
enum md_error
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // No error.
  MD_ERROR_NONE = 0,
  // A pointer is null where it must not be.
  MD_ERROR_NULL = 1,
  // A pointer is not aligned for its type.
  MD_ERROR_MISALIGNED = 2,
  // The memory was never initialised, or its initialisation was refused.
  MD_ERROR_NOT_INITIALIZED = 3,
  // The bytes do not begin like a pack.
  MD_ERROR_PACK_MAGIC = 10,
  // The format version of the pack is too new or too old to be read.
  MD_ERROR_PACK_VERSION = 11,
  // The pack is for another tick rate.
  MD_ERROR_PACK_TICK_RATE = 12,
  // The pack is for another model.
  MD_ERROR_PACK_IDENTITY = 13,
  // The revision of the pack is not above the required one.
  MD_ERROR_PACK_REVISION = 14,
  // The length differs from the length that the pack states.
  MD_ERROR_PACK_LENGTH = 15,
  // The pack's checksum does not match.
  MD_ERROR_PACK_CHECKSUM = 16,
  // The checksum of the pack matches, but its body cannot be read.
  MD_ERROR_PACK_BODY = 17,
  // The pack has version 6, which does not describe its contents.
  MD_ERROR_PACK_SILENT = 18,
  // The law of the pack is not passive: it can give out more energy than it takes.
  MD_ERROR_PACK_ACTIVE = 19,
  // A field is NaN or infinite.
  MD_ERROR_NON_FINITE = 30,
  // A field lies outside its range.
  MD_ERROR_OUT_OF_RANGE = 31,
  // The nodes of a grid do not increase.
  MD_ERROR_NOT_INCREASING = 32,
  // There are more elements than there is room for.
  MD_ERROR_FULL = 33,
  // There is no element where one is needed.
  MD_ERROR_EMPTY = 34,
  // A feature of an earlier version that this version does not have.
  MD_ERROR_REMOVED = 35,
  // The controller is running.
  MD_ERROR_RUNNING = 50,
  // The command is still on its way back to 0.
  MD_ERROR_MOVING = 51,
  // The controller is stopped by a trip that was not cleared, or that occurred again.
  MD_ERROR_FAULTED = 52,
  // There is no trip to clear.
  MD_ERROR_NO_FAULT = 53,
  // A reason that this library has no code for.
  MD_ERROR_OTHER = 99,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_error md_error;
#else
typedef int32_t md_error;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Trip causes of a controller. The numbers do not change.
enum md_trip
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Not stopped by a trip.
  MD_TRIP_NONE = 0,
  // Reading the sensors failed.
  MD_TRIP_ADC_BUS = 1,
  // The actuator did not accept a command.
  MD_TRIP_DAC_BUS = 2,
  // The enable line could not be set.
  MD_TRIP_ENABLE_LINE = 3,
  // The displacement channel is at an end of its range.
  MD_TRIP_DISPLACEMENT_CLIPPED = 4,
  // The force channel is at an end of its range.
  MD_TRIP_FORCE_CLIPPED = 5,
  // The command lies beyond the actuator's range.
  MD_TRIP_COMMAND_CLIPPED = 6,
  // The measured displacement exceeded its limit.
  MD_TRIP_DISPLACEMENT_LIMIT = 7,
  // The measured force exceeded its limit, or the force that an emulation was about to drive.
  MD_TRIP_FORCE_LIMIT = 8,
  // The measured displacement was further from the demanded one than allowed.
  MD_TRIP_TRACKING_LIMIT = 9,
  // Over a cycle outside the ramps, the displacement responded with less than a tenth of the demanded amplitude.
  MD_TRIP_NO_RESPONSE = 10,
  // A force or a command was infinite or NaN.
  MD_TRIP_NOT_FINITE = 11,
  // The displacement channel is stuck or dropped out.
  MD_TRIP_DISPLACEMENT_LOST = 12,
  // The force channel is stuck or dropped out.
  MD_TRIP_FORCE_LOST = 13,
  // Nothing was heard over the link for too long.
  MD_TRIP_LINK_LOST = 14,
  // A tick was late or missing.
  MD_TRIP_TICK_OVERRUN = 15,
  // A motion demanded more than the rig drives.
  MD_TRIP_DEMAND_LIMIT = 16,
  // An external stop input is active.
  MD_TRIP_EXTERNAL = 17,
  // The amplitude correction asks for more command than is allowed.
  MD_TRIP_CORRECTION_LIMIT = 18,
  // A cause that this library has no number for.
  MD_TRIP_OTHER = 99,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_trip md_trip;
#else
typedef int32_t md_trip;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The state of a controller.
enum md_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Enable line low, command at 0 or on its way there.
  MD_STATE_IDLE = 0,
  // Enable line high, command as controlled.
  MD_STATE_RUNNING = 1,
  // The programme has ended; otherwise like MD_STATE_IDLE.
  MD_STATE_DONE = 2,
  // Stopped by a trip until it is cleared; otherwise like MD_STATE_IDLE.
  MD_STATE_FAULTED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_state md_state;
#else
typedef int32_t md_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Memory of a law: the mixed damping law k1*y + k3*y^3 + c*|v|^alpha*sgn v with up to MD_EFFECTS effects, their state, and another
// law that waits. `md_law_init` fills it. It must stay in place: do not copy it.
typedef struct MD_ALIGNED(8) md_law {
  uint8_t storage[MD_LAW_SIZE];
} md_law;

// Requirements on a pack. If all fields are 0, only a passive law is required.
typedef struct md_expected {
  // Ticks per second, Hz: the rate at which the law is called. At 0 any rate is accepted, although the effects of a pack are
  // correct at one rate only.
  float tick_rate;
  // Identity of the required model, MD_IDENTITY bytes; null if any model is accepted.
  const uint8_t *identity;
  // The revision must be above this; null if any revision is accepted.
  const uint32_t *newer_than;
  // Whether a law that is not passive is accepted, such as one with damping below 0. It can drive a system to ever larger
  // motion.
  bool allow_active;
} md_expected;

// The details of a problem. Fields that do not apply are 0 or null.
typedef struct md_problem {
  // The code that the call returns.
  md_error error;
  // The trip cause of a rig or an emulation, for `MD_ERROR_FAULTED`.
  md_trip trip;
  // The field's name. It does not end in NUL: print it with `"%.*s", (int)problem.field_length, problem.field`.
  const char *field;
  // Length of the name, bytes.
  size_t field_length;
  // Value of the field, in its unit; NaN if a pack does not give it.
  double value;
  // Smallest permitted value.
  double low;
  // Largest permitted value.
  double high;
} md_problem;

// One tick of motion as the law sees it. Unknown fields stay 0.
typedef struct md_motion {
  // Displacement, mm; limited to -1e4...1e4, and NaN counts as 0.
  float displacement;
  // Velocity, mm/s; limited to -1e6...1e6, and NaN counts as 0.
  float velocity;
  // Acceleration, mm/s^2; limited to -1e9...1e9, and NaN counts as 0.
  float acceleration;
  // Cycles since the test began, including the fraction of the current one.
  float cycles;
  // Temperature of the specimen, degrees Celsius; a constant if it is not measured.
  float temperature;
  // Control inputs in the units of the effects that depend on them, such as a current in A; 0 for unused ones.
  float controls[MD_CONTROLS];
} md_motion;

// Information of a pack about itself. Unknown fields are 0.
typedef struct md_pack_info {
  // Tick rate of the law, Hz.
  float tick_rate;
  // Revision, which increases from pack to pack of one specimen.
  uint32_t revision;
  // Identity of the model.
  uint8_t identity[MD_IDENTITY];
  // Whether the pack has `displacement` and `velocity`.
  bool has_range;
  // Whether the pack has `density`.
  bool has_density;
  // Whether the pack has `amplitude`.
  bool has_amplitude;
  // Smallest and largest displacement of the motion that the law was fitted on, mm.
  float displacement[2];
  // Smallest and largest velocity of that motion, mm/s.
  float velocity[2];
  // Density of the specimen, g/cm^3.
  float density;
  // Amplitude of the law's coefficients, mm.
  float amplitude;
  // Name of the model, UTF-8, ends in NUL.
  char name[MD_NAME];
} md_pack_info;

// Memory of a cycle accumulator for a caller that knows the phase, for example from `md_sine_tick`.
typedef struct MD_ALIGNED(8) md_cycles {
  uint8_t storage[MD_CYCLES_SIZE];
} md_cycles;

// The results of one cycle. Every field is finite.
typedef struct md_cycle {
  // Largest force, kN.
  float force_max;
  // Smallest force, kN.
  float force_min;
  // Largest displacement, mm.
  float displacement_max;
  // Smallest displacement, mm.
  float displacement_min;
  // Half of the peak-to-peak displacement, mm.
  float amplitude;
  // Energy taken up by the specimen, J.
  float energy;
  // Energy of the first harmonics alone, J.
  float energy_harmonic;
  // Dynamic stiffness, kN/mm; 0 for a cycle without motion.
  float stiffness;
  // Elastic energy at the amplitude, J.
  float elastic_energy;
  // energy / (2*pi*elastic_energy); 0 if the elastic energy is 0.
  float loss_factor;
  // Mean force, kN.
  float mean_force;
  // Mean displacement, mm.
  float mean_displacement;
  // Length of the cycle in ticks, including fractions.
  float ticks;
} md_cycle;

// Memory of a cycle accumulator that finds the cycles of a measured displacement itself.
typedef struct MD_ALIGNED(8) md_crossings {
  uint8_t storage[MD_CROSSINGS_SIZE];
} md_crossings;

// Memory of a programme and its generator.
typedef struct MD_ALIGNED(16) md_sine {
  uint8_t storage[MD_SINE_SIZE];
} md_sine;

// Whole cycles at one amplitude: a sine if both frequencies are the same, otherwise a logarithmic sweep.
typedef struct md_block {
  // Amplitude, mm, 1e-6...1e4.
  double amplitude;
  // Frequency at the start, Hz, 1e-6 to a quarter of the tick rate.
  double from;
  // Frequency at the end, Hz, in the same range.
  double to;
  // Number of cycles at full amplitude, at least 1.
  uint32_t cycles;
} md_block;

// The demand of the generator at one tick. Displacement, velocity and acceleration are derivatives of one another.
typedef struct md_excitation {
  // Displacement, mm.
  float displacement;
  // Velocity, mm/s.
  float velocity;
  // Acceleration, mm/s^2.
  float acceleration;
  // Phase, 2^32 per cycle, for `md_cycles_update`.
  uint32_t phase;
  // Number of cycles completed since the start, including ramps.
  uint32_t cycle;
  // Number of the block, from 0. In a ramp it is the next block; in the final ramp and after it, the last block.
  uint32_t block;
  // Whether the tick is in a ramp.
  bool ramp;
  // Whether this tick is the first of a cycle.
  bool cycle_end;
  // Whether the programme has ended; all quantities then stay at 0.
  bool done;
} md_excitation;

// Memory of a channel's scale: value = full_scale*(code - 32768)/32768 - zero, for 16-bit offset binary. It may be copied.
typedef struct MD_ALIGNED(4) md_scale {
  uint8_t storage[MD_SCALE_SIZE];
} md_scale;

// One reading of a channel.
typedef struct md_sample {
  // Value in the channel's unit. A value that is not finite counts as a missing measurement, and exceeds every limit.
  float value;
  // Code in offset binary, 16 bits. At 0 and 0xFFFF the channel counts as clipped, which stops a controller.
  uint16_t code;
} md_sample;

// Settings of a damper emulation. Begin with `md_emulation_defaults`.
typedef struct md_emulation_settings {
  // Tick rate, Hz, 1...1e6.
  double tick_rate;
  // Largest measured displacement in either direction, mm, 1e-6...1e4.
  double displacement_limit;
  // Largest force in either direction, kN, 1e-6...1e9. A force of the law beyond it stops at once, a measured one after
  // `trip_ticks`.
  double force_limit;
  // Number of ticks beyond the limit of a measured quantity until the trip, 1...1e6. A tick within takes back an eighth of one.
  uint32_t trip_ticks;
  // Number of ticks in which the force rises to its full value after a start, and goes to 0 after a stop or a trip, 1...1e7.
  uint32_t stop_ticks;
  // Number of ticks without `md_emulation_exchange` after which it trips, 0...1e7; 0 without a link.
  uint32_t link_ticks;
  // Rate of the clock whose reading is given at each tick, Hz: 0, or from the tick rate to the smaller of 4e9 and 2e9 times the
  // tick rate. At 0 it counts the ticks of the timer, one each. A clock independent of the timer also detects a timer with a
  // wrong rate.
  double clock_rate;
  // Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
  double observer_bandwidth;
  // Damping ratio of the observer, 0.3...3.
  double observer_damping;
  // Half width of the rest band, mm, 0...1e4. A displacement that has stayed in the band for 0.05 s is at rest. 0 switches this
  // off.
  double rest_band;
  // Number of ticks with an unchanged code after which the displacement channel is stuck, 0...1e9; 0 for a channel without
  // noise.
  uint32_t stuck_ticks;
  // Lowest plausible measured temperature, degrees Celsius, -273...2000.
  double temperature_coldest;
  // Highest plausible measured temperature, degrees Celsius.
  double temperature_hottest;
  // Fastest plausible change of the temperature, degrees Celsius per second, 1e-3...1e3.
  double temperature_rate;
  // Smallest deviation of the displacement from its mean for a cycle to count, mm, 1e-9...1e4.
  double hysteresis;
} md_emulation_settings;

// Memory of a damper emulation. It replaces the damper: it drives the law's force for the displacement that it measures. It does
// no I/O. Each tick takes a reading, and the telemetry contains the command and the level of the enable line.
typedef struct MD_ALIGNED(8) md_emulation {
  uint8_t storage[MD_EMULATION_SIZE];
} md_emulation;

// Scales of the three channels of a controller.
typedef struct md_wiring {
  // Scale of the displacement, mm.
  struct md_scale displacement;
  // Scale of the force, kN.
  struct md_scale force;
  // Scale of the command, mm, or kN for a damper emulation. A command beyond its ends stops the controller.
  struct md_scale command;
} md_wiring;

// The readings of the sensors at one tick.
typedef struct md_reading {
  // Displacement, mm.
  struct md_sample displacement;
  // Force, kN.
  struct md_sample force;
  // Control inputs as in `md_motion`; 0 for unused ones.
  float controls[MD_CONTROLS];
} md_reading;

// One tick of a controller.
typedef struct md_telemetry {
  // Number of ticks since the initialisation, including this one.
  uint64_t tick;
  // Measured displacement, mm; the last value if reading failed.
  float displacement;
  // Observed velocity, mm/s.
  float velocity;
  // Measured force, kN; the last value if reading failed.
  float measured_force;
  // Control inputs as given to the law; the last values if reading failed.
  float controls[MD_CONTROLS];
  // Force of the law at the observed motion, kN.
  float model_force;
  // Command for the actuator until the next tick: mm, or kN for an emulation.
  float command;
  // Block of the programme; 0 for an emulation.
  uint32_t block;
  // Number of cycles completed.
  uint32_t cycle;
  // Phase of the current cycle, 2^32 per cycle.
  uint32_t phase;
  // State after this tick.
  md_state state;
  // Trip cause, for MD_STATE_FAULTED.
  md_trip trip;
  // Level of the enable line.
  bool enabled;
  // Whether the tick is in a ramp of the programme.
  bool ramp;
  // Whether a cycle ended with this tick; the next three fields belong to it.
  bool has_cycle;
  // Results of that cycle with the measured force.
  struct md_cycle measured;
  // Results of that cycle with the law's force.
  struct md_cycle model;
  // RMS of the law's error over the RMS of the measured force.
  float nrmse;
  // Whether the monitor reports an event at this tick, in `event` and its numbers. Never for an emulation.
  bool has_event;
  // The reported cause.
  md_health event;
  // Whether `event_or` is another possible cause that the signals cannot distinguish.
  bool has_event_or;
  // The other possible cause.
  md_health event_or;
  // Change of the monitored quantity.
  float event_value;
  // Permitted change.
  float event_limit;
} md_telemetry;

// Settings of a rig. Begin with `md_rig_defaults`.
typedef struct md_rig_settings {
  // Largest measured displacement in either direction, mm, 1e-6...1e4.
  double displacement_limit;
  // Largest measured force in either direction, kN, 1e-6...1e9.
  double force_limit;
  // Largest difference between measured and demanded displacement, mm, 1e-6...1e4.
  double tracking_limit;
  // Number of ticks beyond one of these limits until the rig trips, 1...1e6. A tick within takes back an eighth of one.
  uint32_t trip_ticks;
  // Number of ticks in which the command goes to 0 after a stop or a trip, 1...1e7.
  uint32_t stop_ticks;
  // Number of ticks without `md_rig_exchange` after which the rig trips, 0...1e7; 0 without a link.
  uint32_t link_ticks;
  // Rate of the clock whose reading is given at each tick, Hz: 0, or from the tick rate to the smaller of 4e9 and 2e9 times the
  // tick rate. At 0 it counts the ticks of the timer, one each. A clock independent of the timer also detects a timer with a
  // wrong rate.
  double clock_rate;
  // Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
  double observer_bandwidth;
  // Damping ratio of the observer, 0.3...3.
  double observer_damping;
  // Fraction of the error of amplitude and phase that is corrected at the end of each cycle, 0...1.
  double correction_gain;
  // Largest increase of the command by the amplitude correction within a block, as a fraction of it, 0.01...10; twice that in
  // the first cycles.
  double correction_limit;
  // Initial lead, s, 0...0.1: the known lag of the actuator.
  double lead;
  // Time constant with which a correction takes effect, s, one tick to 10.
  double glide;
  // Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
  double feedback;
  // Lowest plausible measured temperature, degrees Celsius, -273...2000.
  double temperature_coldest;
  // Highest plausible measured temperature, degrees Celsius.
  double temperature_hottest;
  // Fastest plausible change of the temperature, degrees Celsius per second, 1e-3...1e3.
  double temperature_rate;
  // Smallest lasting relative change that the monitor detects, 0.01...0.5.
  double health_size;
  // Number of cycles between false alarms by Gaussian noise, 1e2...1e9.
  double health_false_alarm_cycles;
  // Number of cycles over which the monitor learns, 8...1000.
  uint32_t health_learning_cycles;
  // Number of cycles after a start in which a slow change is the run-in, 0...1e6.
  uint32_t health_run_in_cycles;
  // Largest relative change of a specimen's force by the temperature, per degree Celsius, 0...0.1.
  double health_temperature_slope;
  // Largest relative change of stiffness or energy in the run-in, 0.01...1.
  double health_run_in_size;
  // Largest adaptation of k1, k3 and c to slow changes, as a fraction of each, 0...0.5; 0 switches adaptation off.
  double health_follow;
} md_rig_settings;

// Memory of a rig with its programme.
typedef struct MD_ALIGNED(16) md_rig {
  uint8_t storage[MD_RIG_SIZE];
} md_rig;

// The programme of a rig.
typedef struct md_programme {
  // Tick rate of the rig, Hz, 1...1e6.
  double tick_rate;
  // Number of cycles in each ramp, at least 1.
  uint32_t ramp_cycles;
  // The blocks, as for `md_sine_init`.
  const struct md_block *blocks;
  // Number of blocks, 1...MD_BLOCKS.
  size_t count;
} md_programme;

// The functions that a rig calls at each tick, in order: `tripped`, `read`, `enable` when the line changes, `drive`, the two
// read-backs, and `alive`. Each returns whether it succeeded, except `tripped`. If one of them fails, except `alive`, the rig
// stops. None may call a function of the same rig or of its law.
typedef struct md_rig_io {
  // Passed to each function unchanged; may be null.
  void *context;
  // Fills in the current displacement, force and control inputs. A channel that is not filled in counts as missing.
  bool (*read)(void *context, struct md_reading *reading);
  // Drives `command`, mm.
  bool (*drive)(void *context, float command);
  // Sets the enable line; a low level stops the actuator.
  bool (*enable)(void *context, bool on);
  // May be null. Returns true while an external stop input is active, or if it cannot be read. It is called at each tick, start
  // and clear. It trips, and prevents a start and a clear.
  bool (*tripped)(void *context);
  // May be null. Checks that the actuator drives the last command, every 16 ticks.
  bool (*verify_drive)(void *context);
  // May be null. Checks that the enable line is at this level, every 16 ticks and after each `enable`.
  bool (*verify_enable)(void *context, bool on);
  // May be null. Called at a clear: sets up the parts again, which may have lost their supply, and drives 0. If it fails, the
  // clear is refused.
  bool (*restore)(void *context);
  // May be null. Tells an external watchdog at the end of a tick that the tick did all its work.
  bool (*alive)(void *context);
} md_rig_io;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The name of an error code as in this header, such as `"MD_ERROR_NULL"`; `"?"` for any other number. It ends in NUL and is never
// null.
const char *md_error_name(int32_t error);

// The remedy for an error code, in one sentence. It ends in NUL and is never null.
const char *md_error_help(int32_t error);

// Loads the law of a pack into `law`, with its effects at rest. If the pack is rejected, `law` is not initialised: its force is 0,
// and no emulation and no rig accepts it.
//
// * `pack`: `length` bytes, as written by `hil export`
// * `expected`: requirements on the pack
// * `problem`: receives the details of an error; may be null
//
// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field in the pack that is
// out of its range.
//
// # Safety
// Each pointer is null or points to memory of its type; `pack` points to `length` bytes.
md_error md_law_init(struct md_law *law,
                     const uint8_t *pack,
                     size_t length,
                     const struct md_expected *expected,
                     struct md_problem *problem);

// Loads the law of another pack in addition to the one in use. It takes over with the next `md_law_boundary`, or at the end of a
// cycle of the emulation or the rig that has `law`. If the pack is rejected, no law waits and the one in use stays. The state of
// the effects is kept if both laws have the same kinds of effects in the same order.
//
// Parameters and codes are those of `md_law_init`, and MD_ERROR_NOT_INITIALIZED. Call it between two ticks, not from an interrupt
// that may come within a tick.
//
// # Safety
// As `md_law_init`.
md_error md_law_load(struct md_law *law,
                     const uint8_t *pack,
                     size_t length,
                     const struct md_expected *expected,
                     struct md_problem *problem);

// Ends a cycle: a waiting law takes over. Returns whether one did; false for a law that is null or not initialised.
//
// # Safety
// `law` is null or points to an `md_law`.
bool md_law_boundary(struct md_law *law);

// Resets all effects to rest, as before the first tick. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `law` is null or points to an `md_law`.
md_error md_law_rest(struct md_law *law);

// The force of this tick, kN: the mixed damping law's plus every effect's. Call it once per tick, in order, at the pack's tick
// rate. It cannot fail, and it is finite for every motion. It is 0 for a pointer that is null or misaligned, and for a law that is
// not initialised or whose pack was rejected.
//
// # Safety
// Each pointer is null or points to memory of its type.
float md_law_force(struct md_law *law,
                   const struct md_motion *motion);

// Reads the information of a pack of `length` bytes into `info`. It does not check the law.
//
// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field outside its range.
// `problem` receives the details, and may be null.
//
// # Safety
// Each pointer is null or points to memory of its type; `pack` points to `length` bytes.
md_error md_pack_describe(const uint8_t *pack, size_t length, struct md_pack_info *info, struct md_problem *problem);

// Call it before the first sample. Called again, it discards the current cycle. Returns MD_ERROR_NONE, MD_ERROR_NULL or
// MD_ERROR_MISALIGNED.
//
// # Safety
// `cycles` is null or points to an `md_cycles`.
md_error md_cycles_init(struct md_cycles *cycles);

// Processes one tick. Returns whether a cycle ended with this tick and was observed from its beginning. Only then are its results
// written to `results`.
//
// * `displacement`: mm; limited to -1e4...1e4, and NaN counts as 0
// * `force`: kN; limited to -1e12...1e12, and NaN counts as 0
// * `phase`: 2^32 per cycle. A cycle ends at the passage through 0. The phase must not go backwards, nor half a cycle or more
//   forward.
// * `results`: may be null
//
// For memory that is null, misaligned or not initialised, no cycle ends.
//
// # Safety
// Each pointer is null or points to memory of its type.
bool md_cycles_update(struct md_cycles *cycles, float displacement, float force, uint32_t phase, struct md_cycle *results);

// Call it before the first sample.
//
// * `hysteresis`: mm, 1e-9...1e4: above the peak of the noise and below the amplitude of the motion
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_crossings_init(struct md_crossings *crossings, float hysteresis, struct md_problem *problem);

// Processes one tick, with displacement and force as in `md_cycles_update`. Returns whether a cycle ended, from the third cycle
// on. Only then are its results written to `results`, which may be null.
//
// # Safety
// Each pointer is null or points to memory of its type.
bool md_crossings_update(struct md_crossings *crossings, float displacement, float force, struct md_cycle *results);

// Initialises a generator at rest, at the start of its programme.
//
// * `tick_rate`: Hz, 1...1e6
// * `ramp_cycles`: number of cycles in each ramp, at least 1. Ramps lead from rest to a block, from block to block and back to
//   rest. Their cycles are in addition to those of the blocks.
// * `blocks`: `count` of them, 1...MD_BLOCKS
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE, MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or
// MD_ERROR_EMPTY.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_sine_init(struct md_sine *sine,
                      double tick_rate,
                      uint32_t ramp_cycles,
                      const struct md_block *blocks,
                      size_t count,
                      struct md_problem *problem);

// Resets to the start of the programme, at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `sine` is null or points to an `md_sine`.
md_error md_sine_restart(struct md_sine *sine);

// The excitation at this tick; the first is at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_sine_tick(struct md_sine *sine, struct md_excitation *excitation);

// Initialises the scale of a converter's channel.
//
// * `full_scale`: the quantity at the positive full scale, 1e-6...1e6 in magnitude; negative if the sensor or the amplifier
//   inverts
// * `zero`: the reading at a quantity of 0, -1e6...1e6
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_scale_init(struct md_scale *scale, double full_scale, double zero, struct md_problem *problem);

// The value of an ADC code.
//
// * `bits`: resolution of the ADC, 1...16; 0 and larger values count as 16
// * `code`: offset binary over the same range. The last code counts as clipped, as 0 does.
//
// For a scale that is null, misaligned or not initialised, the value is NaN, which stops a controller.
//
// # Safety
// `scale` is null or points to an `md_scale`.
struct md_sample md_scale_decode(const struct md_scale *scale, uint32_t bits, uint16_t code);

// The 16-bit DAC code nearest to `value`. Beyond the range it is the code at the end of the range. It is 0x8000, which is 0 V, for
// NaN and for a scale that is null, misaligned or not initialised.
//
// # Safety
// `scale` is null or points to an `md_scale`.
uint16_t md_scale_encode(const struct md_scale *scale,
                         float value);

// The name of a trip cause as in this header, such as `"MD_TRIP_FORCE_LIMIT"`; `"?"` for any other number. It ends in NUL and is
// never null.
const char *md_trip_name(int32_t trip);

// Default settings, for amplitudes of 0.02 to 0.3 mm up to 10 Hz, at 10 kHz. Returns MD_ERROR_NONE, MD_ERROR_NULL or
// MD_ERROR_MISALIGNED.
//
// # Safety
// `settings` is null or points to writable memory for them.
md_error md_emulation_defaults(struct md_emulation_settings *settings);

// Initialises an idle emulation.
//
// * `wiring`: scales of displacement, force and command (kN), each initialised
// * `law`: initialised. It must stay in place while `emulation` is used. `md_law_load` between two ticks loads another law, which
//   takes over at the end of a cycle.
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE or
// MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_emulation_init(struct md_emulation *emulation,
                           const struct md_emulation_settings *settings,
                           const struct md_wiring *wiring,
                           struct md_law *law,
                           struct md_problem *problem);

// Starts driving the law's force, which rises over `stop_ticks`.
//
// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_emulation_start(struct md_emulation *emulation, struct md_problem *problem);

// Stops without a trip. Then set the enable line low: otherwise it stays high until the next tick, whose telemetry reports it.
// Returns the codes of `md_emulation_start` for invalid memory.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_stop(struct md_emulation *emulation);

// Clears the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT or MD_ERROR_MOVING, and the codes of
// `md_emulation_start` for invalid memory; `problem` may be null.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_emulation_clear(struct md_emulation *emulation, struct md_problem *problem);

// Processes one tick, at the tick rate. Then set the enable line to `telemetry->enabled` and drive `telemetry->command` (kN).
//
// * `reading`: null if the sensors failed, which stops the emulation
// * `clock`: reading of a counter that runs freely at `clock_rate` and wraps. A time since the tick before of less than half a
//   tick or more than one and a half trips: a stall, a missing tick, or a tick called twice.
// * `telemetry`: receives the telemetry of this tick
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or MD_ERROR_NOT_INITIALIZED. Set the line low if it is not
// MD_ERROR_NONE.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_emulation_tick(struct md_emulation *emulation,
                           const struct md_reading *reading,
                           uint32_t clock,
                           struct md_telemetry *telemetry);

// Reports that the actuator did not accept the command of the last tick: the emulation trips. Then set the enable line low:
// otherwise it stays high until the next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_command_failed(struct md_emulation *emulation);

// Reports that the actuator's output, as read back, differs from the command: the emulation trips. Then set the enable line low:
// otherwise it stays high until the next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_command_unverified(struct md_emulation *emulation);

// Reports that the enable line could not be set: the emulation trips. Try to set it low now, and again at the next tick: it may
// still be high. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_enable_failed(struct md_emulation *emulation);

// Reports that a tick was late or missing: the emulation trips. Then set the enable line low: otherwise it stays high until the
// next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_overrun(struct md_emulation *emulation);

// Reports that an external stop input is active: the emulation trips, unless it has tripped already. Then set the enable
// line low: otherwise it stays high until the next tick, whose telemetry reports it. Check the input before each start and clear
// too. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_external_trip(struct md_emulation *emulation);

// Reports a message from the other end of a link. Call it for every message. Returns the codes of `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_exchange(struct md_emulation *emulation);

// Sets the temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns the codes of
// `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_set_temperature(struct md_emulation *emulation, float temperature);

// Number of ticks so far that were not in time, in every state. A clear does not change it, and it wraps. If it has increased with
// a tick, give an external watchdog no signal. 0 without an emulation.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
uint32_t md_emulation_late_ticks(struct md_emulation *emulation);

// Default settings, for amplitudes up to 0.3 mm and a few kN, at 0.5 to 10 Hz. Returns MD_ERROR_NONE, MD_ERROR_NULL or
// MD_ERROR_MISALIGNED.
//
// # Safety
// `settings` is null or points to writable memory for them.
md_error md_rig_defaults(struct md_rig_settings *settings);

// Initialises an idle rig; the enable line is set low.
//
// * `programme`: the excitation of the specimen; it is copied
// * `wiring`: scales of displacement, force and command (mm), each initialised
// * `io`: the functions that the rig calls; it is copied, and `read`, `drive` and `enable` must not be null
// * `law`: initialised. It must stay in place while `rig` is used. `md_law_load` between two ticks loads another law, which takes
//   over at the end of a cycle.
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE,
// MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or MD_ERROR_EMPTY.
//
// # Safety
// Each pointer is null or points to memory of its type; the functions of `io` may be called with its context.
md_error md_rig_init(struct md_rig *rig,
                     const struct md_rig_settings *settings,
                     const struct md_programme *programme,
                     const struct md_wiring *wiring,
                     const struct md_rig_io *io,
                     struct md_law *law,
                     struct md_problem *problem);

// Starts the programme from its beginning; the enable line rises.
//
// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_rig_start(struct md_rig *rig, struct md_problem *problem);

// Stops without a trip; the enable line drops within the call. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_stop(struct md_rig *rig);

// Clears the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT, MD_ERROR_MOVING or MD_ERROR_FAULTED,
// and the codes of `md_rig_stop`; `problem` may be null.
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_rig_clear(struct md_rig *rig, struct md_problem *problem);

// Processes one tick, at the programme's tick rate: reads, drives, and sets the enable line. Returns the codes of `md_rig_stop`.
//
// * `clock`: reading of a counter that runs freely at `clock_rate` and wraps. A time since the tick before of less than half a
//   tick or more than one and a half trips: a stall, a missing tick, or a tick called twice.
// * `telemetry`: receives the telemetry of this tick; may be null
//
// # Safety
// Each pointer is null or points to memory of its type.
md_error md_rig_tick(struct md_rig *rig, uint32_t clock, struct md_telemetry *telemetry);

// Reports that a tick was late or missing: the rig trips, and the enable line drops. Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_overrun(struct md_rig *rig);

// Reports that an external stop input is active: the rig trips, unless it has tripped already, and the enable line drops.
// Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_external_trip(struct md_rig *rig);

// Reports a message from the other end of a link. Call it for every message. Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_exchange(struct md_rig *rig);

// Clears all findings of the monitor; the current condition counts as normal. Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_clear_events(struct md_rig *rig);

// Sets the temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_set_temperature(struct md_rig *rig, float temperature);

// Number of ticks so far that were not in time, in every state. A clear does not change it, and it wraps. 0 without a rig.
//
// # Safety
// `rig` is null or points to an `md_rig`.
uint32_t md_rig_late_ticks(struct md_rig *rig);

// At the next start, the rig keeps the learned corrections of amplitude and phase instead of starting from neutral. Do not call it
// after sensors or the actuator were repaired. Returns the codes of `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_keep_correction(struct md_rig *rig);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MESH_DAMPER_H */
