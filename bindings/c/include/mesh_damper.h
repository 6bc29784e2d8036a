/* mesh-damper for C: the law of a metal mesh damper with its effects, per-cycle results, a sine generator, a damper emulation and a rig.
 *
 * Generated from bindings/c of mesh-damper: change that instead. docs/c.md is its page.
 *
 * Units are mm, s, kN and J = kN*mm. All memory is the caller's. No function is called from two contexts at once with the same
 * memory. What runs every tick cannot fail but for memory that was never initialised, and is finite for every finite input.
 */

#ifndef MESH_DAMPER_H
#define MESH_DAMPER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Which sizes are this target's. */
#if UINTPTR_MAX == 0xFFFFFFFFu
#define MD_POINTERS_OF_32_BITS
#elif UINTPTR_MAX == 0xFFFFFFFFFFFFFFFFu
#define MD_POINTERS_OF_64_BITS
#else
#error "mesh_damper.h: a target's pointers have 32 or 64 bits"
#endif

/* Another compiler may define its own. */
#ifndef MD_ALIGNED
#define MD_ALIGNED(bytes) __attribute__((aligned(bytes)))
#endif

// Most effects of a law.
#define MD_EFFECTS 8

// Control inputs of a damper.
#define MD_CONTROLS 4

// Bytes of an identity.
#define MD_IDENTITY 8

#if defined(MD_POINTERS_OF_32_BITS)
// Bytes of `md_law`.
#define MD_LAW_SIZE 8024
#endif

#if defined(MD_POINTERS_OF_64_BITS)
// Bytes of `md_law`.
#define MD_LAW_SIZE 8088
#endif

// Alignment of `md_law`, bytes.
#define MD_LAW_ALIGN 8

// Most bytes of a model's name, and its NUL.
#define MD_NAME 33

// Bytes of `md_cycles`.
#define MD_CYCLES_SIZE 144

// Alignment of `md_cycles`, bytes.
#define MD_CYCLES_ALIGN 8

// Bytes of `md_crossings`.
#define MD_CROSSINGS_SIZE 200

// Alignment of `md_crossings`, bytes.
#define MD_CROSSINGS_ALIGN 8

// Most blocks of a programme.
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
#define MD_RIG_SIZE 4112
#endif

#if defined(MD_POINTERS_OF_64_BITS)
// Bytes of `md_rig`.
#define MD_RIG_SIZE 4288
#endif

// Alignment of `md_rig`, bytes.
#define MD_RIG_ALIGN 16

// Why a call did not do what it was asked. The numbers stay as they are.
enum md_error
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It did.
  MD_ERROR_NONE = 0,
  // A pointer is null that may not be.
  MD_ERROR_NULL = 1,
  // A pointer is not aligned for what it points to.
  MD_ERROR_MISALIGNED = 2,
  // The memory was never initialised, or its initialisation was refused.
  MD_ERROR_NOT_INITIALIZED = 3,
  // The bytes do not begin as a pack does.
  MD_ERROR_PACK_MAGIC = 10,
  // The pack's format version is not read: it is newer or too old.
  MD_ERROR_PACK_VERSION = 11,
  // The pack is for another tick rate.
  MD_ERROR_PACK_TICK_RATE = 12,
  // The pack is of another model.
  MD_ERROR_PACK_IDENTITY = 13,
  // The pack is no newer than is required.
  MD_ERROR_PACK_REVISION = 14,
  // There are more or fewer bytes than the pack says of itself.
  MD_ERROR_PACK_LENGTH = 15,
  // The pack's checksum does not match.
  MD_ERROR_PACK_CHECKSUM = 16,
  // The pack's checksum matches, and its body cannot be read.
  MD_ERROR_PACK_BODY = 17,
  // The pack is of version 6, which says nothing of itself.
  MD_ERROR_PACK_SILENT = 18,
  // The law of the pack gives more energy than it takes.
  MD_ERROR_PACK_ACTIVE = 19,
  // A field is NaN or infinite.
  MD_ERROR_NON_FINITE = 30,
  // A field lies outside its range.
  MD_ERROR_OUT_OF_RANGE = 31,
  // A grid's nodes do not increase.
  MD_ERROR_NOT_INCREASING = 32,
  // There are more elements than fit.
  MD_ERROR_FULL = 33,
  // There is no element where one is needed.
  MD_ERROR_EMPTY = 34,
  // What an earlier version had and this one has not.
  MD_ERROR_REMOVED = 35,
  // It is running.
  MD_ERROR_RUNNING = 50,
  // The command is on its way back to 0.
  MD_ERROR_MOVING = 51,
  // It is stopped by a trip that was not cleared, or that came again.
  MD_ERROR_FAULTED = 52,
  // There is no trip to clear.
  MD_ERROR_NO_FAULT = 53,
  // The crate refuses for a reason that this library does not know.
  MD_ERROR_OTHER = 99,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_error md_error;
#else
typedef int32_t md_error;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why a controller is stopped. The numbers stay as they are.
enum md_trip
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It is not.
  MD_TRIP_NONE = 0,
  // Reading the sensors failed.
  MD_TRIP_ADC_BUS = 1,
  // The actuator did not take a command.
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
  // Over a cycle outside the ramps the displacement answered with less than a tenth of the demanded amplitude.
  MD_TRIP_NO_RESPONSE = 10,
  // A force or a command was infinite or NaN.
  MD_TRIP_NOT_FINITE = 11,
  // The displacement channel is stuck or dropped out.
  MD_TRIP_DISPLACEMENT_LOST = 12,
  // The force channel is stuck or dropped out.
  MD_TRIP_FORCE_LOST = 13,
  // Nothing was heard over the link for too long.
  MD_TRIP_LINK_LOST = 14,
  // A tick came late, or not at all.
  MD_TRIP_TICK_OVERRUN = 15,
  // A motion asked for more than the rig drives.
  MD_TRIP_DEMAND_LIMIT = 16,
  // An input outside of the controller says stop.
  MD_TRIP_EXTERNAL = 17,
  // Amplitude's correction asks for more command than is allowed.
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

// What a controller is doing.
enum md_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Enable line low, command at 0 or on its way there.
  MD_STATE_IDLE = 0,
  // Enable line high, command as controlled.
  MD_STATE_RUNNING = 1,
  // The programme is over; otherwise as MD_STATE_IDLE.
  MD_STATE_DONE = 2,
  // Stopped by a trip, until it is cleared; otherwise as MD_STATE_IDLE.
  MD_STATE_FAULTED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_state md_state;
#else
typedef int32_t md_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the monitor of a rig finds. The numbers are those of the link.
enum md_health
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Stiffness falls, and energy with it.
  MD_HEALTH_WIRE_BREAKAGE = 0,
  // Energy falls, stiffness stays.
  MD_HEALTH_FRICTION_WEAR = 1,
  // A gap opens.
  MD_HEALTH_LOOSENING = 2,
  // The mean force moved at once.
  MD_HEALTH_PRELOAD_SHIFT = 3,
  // Something moved that none of the others explains.
  MD_HEALTH_UNEXPLAINED = 4,
  // Settled after the start: normal.
  MD_HEALTH_RUN_IN = 5,
  // Moved with the temperature: normal.
  MD_HEALTH_TEMPERATURE = 6,
  // The displacement channel shows one value while what it measures moves.
  MD_HEALTH_DISPLACEMENT_STUCK = 7,
  // The force channel does.
  MD_HEALTH_FORCE_STUCK = 8,
  // The displacement channel shows 0 V while what it measures moves.
  MD_HEALTH_DISPLACEMENT_DROPPED_OUT = 9,
  // The force channel does.
  MD_HEALTH_FORCE_DROPPED_OUT = 10,
  // The displacement channel stays at one extreme value.
  MD_HEALTH_DISPLACEMENT_CLIPPED = 11,
  // The force channel does.
  MD_HEALTH_FORCE_CLIPPED = 12,
  // Single samples of the displacement stand out.
  MD_HEALTH_DISPLACEMENT_SPIKING = 13,
  // Single samples of the force do.
  MD_HEALTH_FORCE_SPIKING = 14,
  // What the displacement channel shows at rest moves.
  MD_HEALTH_DISPLACEMENT_DRIFTING = 15,
  // What the force channel shows at rest moves.
  MD_HEALTH_FORCE_DRIFTING = 16,
  // The actuator does not reach what is demanded.
  MD_HEALTH_ACTUATOR_SATURATED = 17,
  // The actuator is late.
  MD_HEALTH_ACTUATOR_LAGGING = 18,
  // The actuator stands still.
  MD_HEALTH_ACTUATOR_DEAD = 19,
  // Energy rises, stiffness stays.
  MD_HEALTH_FRICTION_RISE = 20,
  // Stiffness rises.
  MD_HEALTH_STIFFENING = 21,
  // The displacement channel shows more or less than before for the same quantity.
  MD_HEALTH_DISPLACEMENT_GAIN = 22,
  // The force channel does.
  MD_HEALTH_FORCE_GAIN = 23,
  // The displacement channel has more noise or hum on it than was learned.
  MD_HEALTH_DISPLACEMENT_NOISY = 24,
  // The force channel has.
  MD_HEALTH_FORCE_NOISY = 25,
  // The force does not follow the motion at all.
  MD_HEALTH_SPECIMEN_ABSENT = 26,
  // The displacement channel shows the other sign.
  MD_HEALTH_DISPLACEMENT_REVERSED = 27,
  // The force channel does.
  MD_HEALTH_FORCE_REVERSED = 28,
  // From the start on the specimen is far from the law.
  MD_HEALTH_LAW_MISMATCH = 29,
  // The temperature that is measured cannot be.
  MD_HEALTH_TEMPERATURE_IMPLAUSIBLE = 30,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_health md_health;
#else
typedef int32_t md_health;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Memory of a law: the mixed damping law k1*y + k3*y^3 + c*|v|^alpha*sgn v with up to MD_EFFECTS effects, what these remember, and
// another law that waits. `md_law_init` fills it. It stays where it is: do not copy it.
typedef struct MD_ALIGNED(8) md_law {
  uint8_t storage[MD_LAW_SIZE];
} md_law;

// What a load requires of a pack. Nothing but a passive law where all is 0.
typedef struct md_expected {
  // Ticks per second, Hz: the rate at which the law will be called. 0 where any rate is accepted: the effects of a pack are right
  // at one rate only.
  float tick_rate;
  // Which model it is of, MD_IDENTITY bytes; null where any model is accepted.
  const uint8_t *identity;
  // The revision has to be above this; null where any revision is accepted.
  const uint32_t *newer_than;
  // Takes a law that gives more energy than it takes as well, such as one with damping below 0. What it drives may swing up.
  bool allow_active;
} md_expected;

// What exactly was refused. What does not apply is 0 or null.
typedef struct md_problem {
  // The same code that the call returns.
  md_error error;
  // Why a rig or an emulation is stopped, with `MD_ERROR_FAULTED`.
  md_trip trip;
  // The field's name. It does not end in NUL: print it with `"%.*s", (int)problem.field_length, problem.field`.
  const char *field;
  // Bytes of the name.
  size_t field_length;
  // What the field is, in its unit. NaN where a pack does not say.
  double value;
  // Least that it may be.
  double low;
  // Most that it may be.
  double high;
} md_problem;

// One tick of motion as the law sees it. What is not known stays 0.
typedef struct md_motion {
  // Displacement, mm; limited to -1e4...1e4, and NaN counts as 0.
  float displacement;
  // Velocity, mm/s; limited to -1e6...1e6, and NaN counts as 0.
  float velocity;
  // Acceleration, mm/s^2; limited to -1e9...1e9, and NaN counts as 0.
  float acceleration;
  // Cycles since the test began, the current one's fraction included.
  float cycles;
  // Temperature of the specimen, degrees Celsius. A constant where nothing measures it.
  float temperature;
  // Control inputs in the units of the effects that depend on them, such as a current in A; 0 where there is none.
  float controls[MD_CONTROLS];
} md_motion;

// What a pack says of itself. What it does not say is 0.
typedef struct md_pack_info {
  // Ticks per second that the law is for, Hz.
  float tick_rate;
  // Goes up from pack to pack of one specimen.
  uint32_t revision;
  // Of the model.
  uint8_t identity[MD_IDENTITY];
  // Whether the pack has `displacement` and `velocity`.
  bool has_range;
  // Whether the pack has `density`.
  bool has_density;
  // Whether the pack has `amplitude`.
  bool has_amplitude;
  // Displacement of the motion that the law was fitted on, mm: least and largest.
  float displacement[2];
  // Velocity of that motion, mm/s: least and largest.
  float velocity[2];
  // Density of the specimen, g/cm^3.
  float density;
  // Amplitude that the law was taken at, mm.
  float amplitude;
  // Of the model, UTF-8 that ends in NUL.
  char name[MD_NAME];
} md_pack_info;

// Memory of a cycle accumulator whose caller knows the phase, such as that of `md_sine_tick`.
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
  // Half of the displacement's range, mm.
  float amplitude;
  // Energy that the specimen took up, J.
  float energy;
  // The same of the first harmonics alone, J.
  float energy_harmonic;
  // Dynamic stiffness, kN/mm. 0 of a cycle that stands still.
  float stiffness;
  // Elastic energy at the amplitude, J.
  float elastic_energy;
  // energy / (2*pi*elastic_energy). 0 where the elastic energy is.
  float loss_factor;
  // Mean force, kN.
  float mean_force;
  // Mean displacement, mm.
  float mean_displacement;
  // Length of the cycle in ticks, fractions included.
  float ticks;
} md_cycle;

// Memory of a cycle accumulator that finds the cycles of a measured displacement by itself.
typedef struct MD_ALIGNED(8) md_crossings {
  uint8_t storage[MD_CROSSINGS_SIZE];
} md_crossings;

// Memory of a programme and its generator.
typedef struct MD_ALIGNED(16) md_sine {
  uint8_t storage[MD_SINE_SIZE];
} md_sine;

// Whole cycles at one amplitude: a sine where both frequencies are the same, and a logarithmic sweep otherwise.
typedef struct md_block {
  // mm, 1e-6...1e4.
  double amplitude;
  // Frequency at the start, Hz, 1e-6 to a quarter of the tick rate.
  double from;
  // Frequency at the end, Hz, of the same range.
  double to;
  // Cycles at full amplitude, at least 1.
  uint32_t cycles;
} md_block;

// What the generator asks for at one tick: displacement, velocity and acceleration are the derivatives of one another.
typedef struct md_excitation {
  // mm.
  float displacement;
  // mm/s.
  float velocity;
  // mm/s^2.
  float acceleration;
  // 2^32 to the cycle, for `md_cycles_update`.
  uint32_t phase;
  // Cycles completed since the start, ramps included.
  uint32_t cycle;
  // Which block, from 0: in a ramp the one ahead, in the ramp to rest and after it the last.
  uint32_t block;
  // In a ramp.
  bool ramp;
  // This tick is the first of a cycle.
  bool cycle_end;
  // The programme is over: everything stays at 0.
  bool done;
} md_excitation;

// Memory of a channel's scale: value = full_scale*(code - 32768)/32768 - zero, of 16 bits offset binary. It may be copied.
typedef struct MD_ALIGNED(4) md_scale {
  uint8_t storage[MD_SCALE_SIZE];
} md_scale;

// One channel's reading.
typedef struct md_sample {
  // In the channel's unit. What is not finite counts as a missing measurement, and exceeds every limit.
  float value;
  // Offset binary, 16 bits. At 0 and 0xFFFF the channel counts as clipped, which stops a controller.
  uint16_t code;
} md_sample;

// What a damper emulation is set to. Begin with `md_emulation_defaults`.
typedef struct md_emulation_settings {
  // Hz, 1...1e6.
  double tick_rate;
  // Largest measured displacement in either direction, mm, 1e-6...1e4.
  double displacement_limit;
  // Largest force in either direction, kN, 1e-6...1e9: of the law, at once, and as measured.
  double force_limit;
  // For how many ticks on end a measured quantity must exceed its limit to stop, 1...1e6.
  uint32_t trip_ticks;
  // In how many ticks the force comes in once started, and goes to 0 once stopped, 1...1e7.
  uint32_t stop_ticks;
  // After how many ticks without `md_emulation_exchange` it stops, 0...1e7; 0 where nobody is linked.
  uint32_t link_ticks;
  // Rate of the counter whose reading each tick is given, Hz: 0, or the tick rate to 4e9 and to 2e9 times the tick rate. At 0 it
  // counts the ticks of the timer, one each. A clock that is independent of the timer also finds a timer at a wrong rate.
  double clock_rate;
  // Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
  double observer_bandwidth;
  // Damping ratio of the observer, 0.3...3.
  double observer_damping;
  // Half width of the band in which a displacement is at rest that has stayed there for 0.05 s, mm, 0...1e4; 0 where nothing is rest.
  double rest_band;
  // After how many ticks of the very same code the displacement channel is stuck, 0...1e9; 0 where it has no noise at all.
  uint32_t stuck_ticks;
  // Coldest that a measured temperature can be, degrees Celsius, -273...2000.
  double temperature_coldest;
  // Hottest that it can be.
  double temperature_hottest;
  // Fastest that it can change, degrees a second, 1e-3...1e3.
  double temperature_rate;
  // How far the displacement must go from its mean for a cycle to count, mm, 1e-9...1e4.
  double hysteresis;
} md_emulation_settings;

// Memory of a damper emulation: it is the damper, and drives the law's force for the displacement that it measures. It does no I/O:
// each tick takes a reading, and its telemetry has the command and the level of the enable line.
typedef struct MD_ALIGNED(8) md_emulation {
  uint8_t storage[MD_EMULATION_SIZE];
} md_emulation;

// Scales of the three channels that a controller is wired to.
typedef struct md_wiring {
  // Of the displacement, mm.
  struct md_scale displacement;
  // Of the force, kN.
  struct md_scale force;
  // Of the command, mm, or kN of a damper emulation. A command beyond its ends stops the controller.
  struct md_scale command;
} md_wiring;

// What the sensors say at one tick.
typedef struct md_reading {
  // mm.
  struct md_sample displacement;
  // kN.
  struct md_sample force;
  // Control inputs as in `md_motion`; 0 where there is none.
  float controls[MD_CONTROLS];
} md_reading;

// One tick, as a controller saw it.
typedef struct md_telemetry {
  // Ticks since the initialisation, this one included.
  uint64_t tick;
  // Measured displacement, mm. The last one read, where reading failed.
  float displacement;
  // Observed velocity, mm/s.
  float velocity;
  // Measured force, kN. The last one read, where reading failed.
  float measured_force;
  // Control inputs as the law was given them. The last ones read, where reading failed.
  float controls[MD_CONTROLS];
  // Force of the law at the observed motion, kN.
  float model_force;
  // What the actuator is to drive until the next tick: mm, or kN of an emulation.
  float command;
  // Block of the programme; 0 of an emulation.
  uint32_t block;
  // Cycles completed.
  uint32_t cycle;
  // Phase of the cycle under way, 2^32 to the cycle.
  uint32_t phase;
  // What it is doing after this tick.
  md_state state;
  // Why it is stopped, with MD_STATE_FAULTED.
  md_trip trip;
  // Level of the enable line.
  bool enabled;
  // In a ramp of the programme.
  bool ramp;
  // Whether a cycle ended with this tick: the next three fields are of it.
  bool has_cycle;
  // The results of that cycle with the measured force.
  struct md_cycle measured;
  // The same with the law's force.
  struct md_cycle model;
  // RMS of the law's error over the RMS of the measured force.
  float nrmse;
  // Whether the monitor found something at this tick: `event` and its numbers. Never of an emulation.
  bool has_event;
  // What it found.
  md_health event;
  // Whether it may be something else as well, which what is measured cannot tell apart: `event_or`.
  bool has_event_or;
  // What that is.
  md_health event_or;
  // By how much what is watched moved.
  float event_value;
  // By how much it may.
  float event_limit;
} md_telemetry;

// What a rig is set to. Begin with `md_rig_defaults`.
typedef struct md_rig_settings {
  // Largest measured displacement in either direction, mm, 1e-6...1e4.
  double displacement_limit;
  // Largest measured force in either direction, kN, 1e-6...1e9.
  double force_limit;
  // Largest distance of the measured displacement from the demanded one, mm, 1e-6...1e4.
  double tracking_limit;
  // For how many ticks on end one of these must be exceeded to stop the rig, 1...1e6.
  uint32_t trip_ticks;
  // In how many ticks the command goes to 0 once stopped, 1...1e7.
  uint32_t stop_ticks;
  // After how many ticks without `md_rig_exchange` it stops, 0...1e7; 0 where nobody is linked.
  uint32_t link_ticks;
  // Rate of the counter whose reading each tick is given, Hz: 0, or the tick rate to 4e9 and to 2e9 times the tick rate. At 0 it
  // counts the ticks of the timer, one each. A clock that is independent of the timer also finds a timer at a wrong rate.
  double clock_rate;
  // Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
  double observer_bandwidth;
  // Damping ratio of the observer, 0.3...3.
  double observer_damping;
  // Part of the error of amplitude and phase that is corrected at the end of each cycle, 0...1.
  double correction_gain;
  // Most by which amplitude's correction may have the command grow within a block, part of it, 0.01...10; twice that in its first cycles.
  double correction_limit;
  // Lead to begin with, s, 0...0.1: what the actuator is known to lag.
  double lead;
  // Time constant with which a correction takes effect, s, one tick to 10.
  double glide;
  // Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
  double feedback;
  // Coldest that a measured temperature can be, degrees Celsius, -273...2000.
  double temperature_coldest;
  // Hottest that it can be.
  double temperature_hottest;
  // Fastest that it can change, degrees a second, 1e-3...1e3.
  double temperature_rate;
  // Smallest lasting change that the monitor is to find, part of it, 0.01...0.5.
  double health_size;
  // Cycles between false alarms of Gaussian noise, 1e2...1e9.
  double health_false_alarm_cycles;
  // Cycles over which the monitor learns, 8...1000.
  uint32_t health_learning_cycles;
  // Cycles after a start within which a slow change is the run-in, 0...1e6.
  uint32_t health_run_in_cycles;
  // Most by which temperature changes a specimen's force, part of it per degree, 0...0.1.
  double health_temperature_slope;
  // Most by which stiffness or energy may change in the run-in, part of them, 0.01...1.
  double health_run_in_size;
  // Most by which the law follows a slow change of its coefficients, part of each, 0...0.5.
  double health_follow;
} md_rig_settings;

// Memory of a rig with its programme.
typedef struct MD_ALIGNED(16) md_rig {
  uint8_t storage[MD_RIG_SIZE];
} md_rig;

// The programme of a rig.
typedef struct md_programme {
  // Ticks per second of the rig, Hz, 1...1e6.
  double tick_rate;
  // Cycles of each ramp, at least 1.
  uint32_t ramp_cycles;
  // As `md_sine_init` takes them.
  const struct md_block *blocks;
  // How many blocks, 1...MD_BLOCKS.
  size_t count;
} md_programme;

// What a rig calls at each tick: in order `tripped`, `read`, `enable` where the line changes, `drive`, the two read-backs, and `alive`.
// Each but `tripped` returns whether it succeeded; where one other than `alive` did not, the rig stops. None may call a function of
// the same rig or of its law.
typedef struct md_rig_io {
  // Goes to each of them as it is; may be null.
  void *context;
  // Fills in displacement, force and control inputs of now. A channel that is not filled in counts as missing.
  bool (*read)(void *context, struct md_reading *reading);
  // Drives `command`, mm.
  bool (*drive)(void *context, float command);
  // Sets the enable line; low stops the actuator.
  bool (*enable)(void *context, bool on);
  // May be null. Returns true while an input from outside says stop, and where it cannot be read: asked at each tick, start and
  // clear. It trips, and refuses a start and a clear.
  bool (*tripped)(void *context);
  // May be null. Reads back that the last command is driven, every 16 ticks.
  bool (*verify_drive)(void *context);
  // May be null. Reads back that the enable line is at this level, every 16 ticks and after each `enable`.
  bool (*verify_enable)(void *context, bool on);
  // May be null. Sets the parts up again, which may have lost their supply, and drives 0: at a clear, which is refused where it
  // does not succeed.
  bool (*restore)(void *context);
  // May be null. Tells an external watchdog that a tick did all it had to, at the end of each that did.
  bool (*alive)(void *context);
} md_rig_io;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The name of an error code as it stands in this header, such as `"MD_ERROR_NULL"`; `"?"` for any other number. It ends in NUL and
// is never null.
const char *md_error_name(int32_t error);

// What to do about an error code, in one sentence. It ends in NUL and is never null.
const char *md_error_help(int32_t error);

// Reads the law of a pack into `law`, its effects at rest. Where the pack is refused `law` is not initialised: its force is 0, and no
// emulation and no rig takes it.
//
// * `pack`: `length` bytes, as `hil export` writes them
// * `expected`: what the pack has to be
// * `problem`: gets what exactly is refused; may be null
//
// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field in the pack that is
// out of its range.
//
// # Safety
// Each pointer is null or points to what its type says; `pack` points to `length` bytes.
md_error md_law_init(struct md_law *law,
                     const uint8_t *pack,
                     size_t length,
                     const struct md_expected *expected,
                     struct md_problem *problem);

// Reads the law of another pack beside the one in force. It takes over with the next `md_law_boundary`, or at the end of a cycle of
// the emulation or the rig that has `law`. Where the pack is refused no law waits, and the one in force stays. What the effects
// remember is kept where both laws have the same kinds of effects in the same order.
//
// Parameters and returned codes are those of `md_law_init`, and MD_ERROR_NOT_INITIALIZED. Call it between two ticks, not from an
// interrupt that may come within one.
//
// # Safety
// As `md_law_init`.
md_error md_law_load(struct md_law *law,
                     const uint8_t *pack,
                     size_t length,
                     const struct md_expected *expected,
                     struct md_problem *problem);

// A cycle has ended: the law that waits takes over. Returns whether one did. A law that is null or not initialised has none.
//
// # Safety
// `law` is null or points to an `md_law`.
bool md_law_boundary(struct md_law *law);

// Puts all effects to rest, as before the first tick. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `law` is null or points to an `md_law`.
md_error md_law_rest(struct md_law *law);

// The force of this tick, kN: the mixed damping law's and every effect's. Call it once per tick, in order, at the pack's tick rate.
// It cannot fail, and is finite for every motion. It is 0 for a pointer that is null or misaligned, and for a law that is not
// initialised or whose pack was refused.
//
// # Safety
// Each pointer is null or points to what its type says.
float md_law_force(struct md_law *law,
                   const struct md_motion *motion);

// Reads what a pack of `length` bytes says of itself into `info`. Its law is not looked at.
//
// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field that is out of its
// range; `problem` gets the details, and may be null.
//
// # Safety
// Each pointer is null or points to what its type says; `pack` points to `length` bytes.
md_error md_pack_describe(const uint8_t *pack, size_t length, struct md_pack_info *info, struct md_problem *problem);

// Before the first sample; again, it forgets the cycle under way. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
//
// # Safety
// `cycles` is null or points to an `md_cycles`.
md_error md_cycles_init(struct md_cycles *cycles);

// One tick. Returns whether a cycle ended with it that was seen from its beginning: `results` has it then, and is left as it was
// otherwise.
//
// * `displacement`: mm; limited to -1e4...1e4, and NaN counts as 0
// * `force`: kN; limited to -1e12...1e12, and NaN counts as 0
// * `phase`: 2^32 to the cycle, and a cycle ends where it passes through 0. It must not go backwards, nor half a cycle or more
//   forward.
// * `results`: may be null
//
// For memory that is null, misaligned or not initialised no cycle ends.
//
// # Safety
// Each pointer is null or points to what its type says.
bool md_cycles_update(struct md_cycles *cycles, float displacement, float force, uint32_t phase, struct md_cycle *results);

// Before the first sample.
//
// * `hysteresis`: mm, 1e-9...1e4: above the noise's peak and below the motion's amplitude
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_crossings_init(struct md_crossings *crossings, float hysteresis, struct md_problem *problem);

// One tick, with displacement and force as in `md_cycles_update`. Returns whether a cycle ended, from the third on; `results` has it
// then, and may be null.
//
// # Safety
// Each pointer is null or points to what its type says.
bool md_crossings_update(struct md_crossings *crossings,
                         float displacement,
                         float force,
                         struct md_cycle *results);

// A generator at rest, at the start of its programme.
//
// * `tick_rate`: Hz, 1...1e6
// * `ramp_cycles`: cycles of each ramp, at least 1: they lead from rest to a block, from block to block and back to rest, beside the
//   cycles of the blocks
// * `blocks`: `count` of them, 1...MD_BLOCKS
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE, MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or
// MD_ERROR_EMPTY.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_sine_init(struct md_sine *sine,
                      double tick_rate,
                      uint32_t ramp_cycles,
                      const struct md_block *blocks,
                      size_t count,
                      struct md_problem *problem);

// Back to the start of the programme, at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `sine` is null or points to an `md_sine`.
md_error md_sine_restart(struct md_sine *sine);

// The excitation at this tick; the first is at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_sine_tick(struct md_sine *sine, struct md_excitation *excitation);

// Of a converter's channel.
//
// * `full_scale`: the quantity at the positive full scale, 1e-6...1e6 in size; negative where the sensor or the amplifier inverts
// * `zero`: what the channel reads when the quantity is 0, -1e6...1e6
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_scale_init(struct md_scale *scale, double full_scale, double zero, struct md_problem *problem);

// What a code of an ADC stands for.
//
// * `bits`: of the ADC, 1...16: 16 and 0 are the same, and more than 16 are 16
// * `code`: offset binary over the same range. The last code counts as clipped, as 0 does.
//
// Of a scale that is null, misaligned or not initialised the value is NaN, which stops a controller.
//
// # Safety
// `scale` is null or points to an `md_scale`.
struct md_sample md_scale_decode(const struct md_scale *scale, uint32_t bits, uint16_t code);

// The code of 16 bits nearest to `value`, for a DAC: the range's end beyond it, and 0x8000, which is 0 V, for NaN and for a scale that
// is null, misaligned or not initialised.
//
// # Safety
// `scale` is null or points to an `md_scale`.
uint16_t md_scale_encode(const struct md_scale *scale,
                         float value);

// The name of a trip's cause as it stands in this header, such as `"MD_TRIP_FORCE_LIMIT"`; `"?"` for any other number. It ends in
// NUL and is never null.
const char *md_trip_name(int32_t trip);

// Settings for amplitudes of 0.02 to 0.3 mm up to 10 Hz, at 10 kHz. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
//
// # Safety
// `settings` is null or points to writable memory for them.
md_error md_emulation_defaults(struct md_emulation_settings *settings);

// An idle emulation.
//
// * `wiring`: scales of displacement, force and command (kN), each initialised
// * `law`: initialised; it stays where it is as long as `emulation` is used. `md_law_load` between two ticks gives another law, which
//   takes over at the end of a cycle.
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE or
// MD_ERROR_OUT_OF_RANGE.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_emulation_init(struct md_emulation *emulation,
                           const struct md_emulation_settings *settings,
                           const struct md_wiring *wiring,
                           struct md_law *law,
                           struct md_problem *problem);

// Begins to drive the law's force, which comes in over `stop_ticks`.
//
// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_emulation_start(struct md_emulation *emulation, struct md_problem *problem);

// Stops without a trip. Set the enable line low then: otherwise it stays high until the next tick, which says so. Returns as
// `md_emulation_start` where memory is not right.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_stop(struct md_emulation *emulation);

// Forgets the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT or MD_ERROR_MOVING, and as
// `md_emulation_start` where memory is not right; `problem` may be null.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_emulation_clear(struct md_emulation *emulation, struct md_problem *problem);

// One tick, at the tick rate. Set the enable line to `telemetry->enabled` and drive `telemetry->command` (kN) then.
//
// * `reading`: null where the sensors failed, which stops it
// * `clock`: what a counter reads that runs freely at `clock_rate` and wraps. Less than half a tick or more than one and a half since
//   the tick before trips: a stall, a tick that is missing or called twice.
// * `telemetry`: gets what it saw
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or MD_ERROR_NOT_INITIALIZED: set the line low then.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_emulation_tick(struct md_emulation *emulation,
                           const struct md_reading *reading,
                           uint32_t clock,
                           struct md_telemetry *telemetry);

// The actuator did not take the command of the last tick: it trips. Set the enable line low then: otherwise it stays high until the
// next tick, which says so. Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_command_failed(struct md_emulation *emulation);

// What the actuator drives, as it is read back, is not the command: it trips. Set the enable line low then: otherwise it stays high
// until the next tick, which says so. Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_command_unverified(struct md_emulation *emulation);

// The enable line could not be set: it trips. Try to set it low then, and again at the next tick: it may still be high. Returns as
// `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_enable_failed(struct md_emulation *emulation);

// A tick came late, or not at all: it trips. Set the enable line low then: otherwise it stays high until the next tick, which says so.
// Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_overrun(struct md_emulation *emulation);

// An input outside of the emulation says stop: it trips in any state without a trip. Set the enable line low then: otherwise it stays
// high until the next tick, which says so. Ask the input before each start and clear too. Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_external_trip(struct md_emulation *emulation);

// Whoever is at the other end of a link was heard: call it as often as that is so. Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_exchange(struct md_emulation *emulation);

// Temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns as `md_emulation_stop`.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
md_error md_emulation_set_temperature(struct md_emulation *emulation, float temperature);

// Ticks so far that did not come in time, in every state; a clear leaves them. It wraps. Where it has gone up with a tick, give an external
// watchdog no signal. 0 of no emulation.
//
// # Safety
// `emulation` is null or points to an `md_emulation`.
uint32_t md_emulation_late_ticks(struct md_emulation *emulation);

// Settings for amplitudes up to 0.3 mm and a few kN, at 0.5 to 10 Hz. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
//
// # Safety
// `settings` is null or points to writable memory for them.
md_error md_rig_defaults(struct md_rig_settings *settings);

// An idle rig; the enable line is set low.
//
// * `programme`: what it excites the specimen by; it is copied
// * `wiring`: scales of displacement, force and command (mm), each initialised
// * `io`: what it calls; it is copied, and `read`, `drive` and `enable` may not be null
// * `law`: initialised; it stays where it is as long as `rig` is used. `md_law_load` between two ticks gives another law, which takes
//   over at the end of a cycle.
// * `problem`: may be null
//
// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE,
// MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or MD_ERROR_EMPTY.
//
// # Safety
// Each pointer is null or points to what its type says; the functions of `io` may be called with its context.
md_error md_rig_init(struct md_rig *rig,
                     const struct md_rig_settings *settings,
                     const struct md_programme *programme,
                     const struct md_wiring *wiring,
                     const struct md_rig_io *io,
                     struct md_law *law,
                     struct md_problem *problem);

// Begins the programme from its start; the enable line rises.
//
// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_rig_start(struct md_rig *rig, struct md_problem *problem);

// Stops without a trip; the enable line drops within the call. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
// MD_ERROR_NOT_INITIALIZED.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_stop(struct md_rig *rig);

// Forgets the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT, MD_ERROR_MOVING or MD_ERROR_FAULTED,
// and as `md_rig_stop`; `problem` may be null.
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_rig_clear(struct md_rig *rig, struct md_problem *problem);

// One tick, at the programme's tick rate: reads, drives, and sets the enable line. Returns as `md_rig_stop`.
//
// * `clock`: what a counter reads that runs freely at `clock_rate` and wraps. Less than half a tick or more than one and a half since
//   the tick before trips: a stall, a tick that is missing or called twice.
// * `telemetry`: gets what it saw, and may be null
//
// # Safety
// Each pointer is null or points to what its type says.
md_error md_rig_tick(struct md_rig *rig,
                     uint32_t clock,
                     struct md_telemetry *telemetry);

// A tick came late, or not at all: it trips, and the enable line drops. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_overrun(struct md_rig *rig);

// An input outside of the rig says stop: it trips in any state without a trip, and the enable line drops. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_external_trip(struct md_rig *rig);

// Whoever is at the other end of a link was heard: call it as often as that is so. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_exchange(struct md_rig *rig);

// Forgets all that the monitor found; what is now counts as normal. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_clear_events(struct md_rig *rig);

// Temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_set_temperature(struct md_rig *rig, float temperature);

// Ticks so far that did not come in time, in every state; a clear leaves them. It wraps. 0 of no rig.
//
// # Safety
// `rig` is null or points to an `md_rig`.
uint32_t md_rig_late_ticks(struct md_rig *rig);

// The next start keeps what the corrections of amplitude and phase have learned, instead of starting from neutral. Not after sensors or
// actuator were repaired. Returns as `md_rig_stop`.
//
// # Safety
// `rig` is null or points to an `md_rig`.
md_error md_rig_keep_correction(struct md_rig *rig);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MESH_DAMPER_H */
