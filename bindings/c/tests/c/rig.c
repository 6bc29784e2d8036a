/* The rig, through its callbacks: a start, some cycles, a stop, the end of a programme, and a failure of each callback. */
#include "check.h"

#define AMPLITUDE 0.1
#define FREQUENCY 5.0

/* An actuator that is at the commanded position, and a specimen with the rig's own law. */
struct bench {
    md_law specimen;
    float position, before;
    float controls[MD_CONTROLS];
    bool enabled, no_reading, no_drive, no_enable;
    bool tripped, not_driven, other_level, no_part;
    uint32_t alive;
    uint32_t reads, drives;
};

static struct bench bench;
static md_law law;
static md_rig rig;
static md_wiring wiring;
static md_telemetry seen;

static bool read_sensors(void *context, md_reading *reading)
{
    struct bench *of = context;
    of->reads++;
    if (of->no_reading)
        return false;
    const md_motion motion = {
        .displacement = of->position,
        .velocity = (of->position - of->before) * LINEAR_TICK_RATE,
        .temperature = 20.0f,
    };
    of->before = of->position;
    const float force = md_law_force(&of->specimen, &motion);
    reading->displacement = md_scale_decode(&wiring.displacement, 16, md_scale_encode(&wiring.displacement, of->position));
    reading->force = md_scale_decode(&wiring.force, 16, md_scale_encode(&wiring.force, force));
    memcpy(reading->controls, of->controls, sizeof of->controls);
    return true;
}

static bool drive(void *context, float command)
{
    struct bench *of = context;
    of->drives++;
    if (of->no_drive)
        return false;
    of->position = command;
    return true;
}

static bool enable(void *context, bool on)
{
    struct bench *of = context;
    if (of->no_enable && on)
        return false;
    of->enabled = on;
    return true;
}

static bool is_tripped(void *context)
{
    return ((struct bench *)context)->tripped;
}

static bool verify_drive(void *context)
{
    return !((struct bench *)context)->not_driven;
}

static bool verify_enable(void *context, bool on)
{
    const struct bench *of = context;
    return on == of->enabled && !of->other_level;
}

static bool restore(void *context)
{
    const struct bench *of = context;
    return !of->enabled && !of->no_part;
}

static bool alive(void *context)
{
    ((struct bench *)context)->alive++;
    return true;
}

/* Ticks so far, which serve as the clock. */
static uint32_t ticks;

static void tick(void)
{
    CHECK(md_rig_tick(&rig, ticks++, &seen) == MD_ERROR_NONE);
    CHECK(bench.enabled == seen.enabled);
}

/* The telemetry contains the control inputs that the callback fills in; if it fails, the previous ones stay. */
static void check_controls(void)
{
    const float none[MD_CONTROLS] = {0.0f}, given[MD_CONTROLS] = {0.5f, -1.5f, 2.5f, -3.5f};
    tick();
    CHECK(memcmp(seen.controls, none, sizeof none) == 0);
    memcpy(bench.controls, given, sizeof given);
    tick();
    CHECK(memcmp(seen.controls, given, sizeof given) == 0);
    memcpy(bench.controls, none, sizeof none);
    bench.no_reading = true;
    tick();
    CHECK(seen.trip == MD_TRIP_ADC_BUS && memcmp(seen.controls, given, sizeof given) == 0);
    bench.no_reading = false;
    tick();
    CHECK(memcmp(seen.controls, none, sizeof none) == 0);
    CHECK(md_rig_clear(&rig, NULL) == MD_ERROR_NONE);
}

/* Ticks until the command is back at 0. */
static void rest(uint32_t stop_ticks)
{
    for (uint32_t i = 0; i < stop_ticks + 2; i++) {
        tick();
        CHECK(!bench.enabled);
    }
    CHECK(bench.position == 0.0f);
}

/* Another law while it runs, with a specimen that stays linear: the rig's model is that of `linear.c` from the first cycle that
 * begins after the load. */
static void check_load(const md_rig_settings *settings, const md_rig_io *io)
{
    const md_expected expected = {.tick_rate = LINEAR_TICK_RATE};
    const md_block block = {.amplitude = AMPLITUDE, .from = FREQUENCY, .to = FREQUENCY, .cycles = 12};
    const md_programme programme = {.tick_rate = LINEAR_TICK_RATE, .ramp_cycles = 1, .blocks = &block, .count = 1};
    md_problem problem;
    CHECK(md_law_init(&law, mount_pack, MOUNT_PACK_LENGTH, &expected, NULL) == MD_ERROR_NONE);
    load_linear(&bench.specimen);
    CHECK(md_rig_init(&rig, settings, &programme, &wiring, io, &law, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    uint32_t others = 0, after = 0, linear = 0;
    bool loaded = false;
    while (tick(), seen.state == MD_STATE_RUNNING) {
        if (!loaded && others == 2 && bench.position > 0.05f) {
            CHECK(md_law_load(&law, linear_pack, LINEAR_PACK_LENGTH - 1, &expected, &problem) == MD_ERROR_PACK_LENGTH);
            CHECK(md_law_load(&law, linear_pack, LINEAR_PACK_LENGTH, &expected, &problem) == MD_ERROR_NONE);
            loaded = true;
        }
        if (seen.has_cycle && !seen.ramp && seen.cycle > 2) {
            const int is_linear = is_near(seen.model.stiffness, linear_stiffness(FREQUENCY), 1e-2);
            after += loaded;
            CHECK(is_near(seen.measured.stiffness, linear_stiffness(FREQUENCY), 1e-2));
            CHECK(is_linear == (after > 1));
            others += !is_linear;
            linear += is_linear;
        }
    }
    CHECK(others >= 3 && linear >= 2 && seen.state == MD_STATE_DONE);
    printf("a law loaded while the rig runs is its model for %lu cycles\n", (unsigned long)linear);
    rest(settings->stop_ticks);
}

/* Up to 16 ticks until it trips with this cause. */
static void trips(md_trip trip)
{
    for (int i = 0; i < 16 && seen.state == MD_STATE_RUNNING; i++)
        tick();
    CHECK(seen.trip == trip && !bench.enabled);
}

static void clear_and_start(const md_rig_settings *settings)
{
    md_problem problem;
    rest(settings->stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    tick();
    CHECK(seen.state == MD_STATE_RUNNING);
}

/* The optional callbacks: each trips the rig, and prevents a clear. */
static void check_supervision(const md_rig_settings *settings, const md_programme *programme, const md_rig_io *plain)
{
    md_problem problem;
    md_rig_io io = *plain;
    io.tripped = is_tripped;
    io.verify_drive = verify_drive;
    io.verify_enable = verify_enable;
    io.restore = restore;
    io.alive = alive;
    load_linear(&law);
    load_linear(&bench.specimen);
    CHECK(md_rig_init(&rig, settings, programme, &wiring, &io, &law, &problem) == MD_ERROR_NONE);
    bench.position = bench.before = 0.0f;
    tick();
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    bench.alive = 0;
    for (int i = 0; i < 100; i++)
        tick();
    CHECK(seen.state == MD_STATE_RUNNING && bench.alive == 100);

    bench.tripped = true;
    trips(MD_TRIP_EXTERNAL);
    rest(settings->stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_FAULTED && problem.trip == MD_TRIP_EXTERNAL);
    bench.tripped = false;
    clear_and_start(settings);

    bench.not_driven = true;
    trips(MD_TRIP_DAC_BUS);
    bench.alive = 0;
    rest(settings->stop_ticks);
    CHECK(bench.alive == 0);
    bench.not_driven = false;
    bench.no_part = true;
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_FAULTED && problem.trip == MD_TRIP_DAC_BUS);
    bench.no_part = false;
    clear_and_start(settings);

    bench.other_level = true;
    trips(MD_TRIP_ENABLE_LINE);
    bench.other_level = false;
    clear_and_start(settings);
    CHECK(md_rig_stop(&rig) == MD_ERROR_NONE);
}

void check_rig(void)
{
    md_rig_settings settings;
    md_problem problem;
    CHECK(md_rig_defaults(&settings) == MD_ERROR_NONE);
    settings.stop_ticks = 500;
    const md_block blocks[] = {
        {.amplitude = AMPLITUDE, .from = FREQUENCY, .to = FREQUENCY, .cycles = 4},
        {.amplitude = AMPLITUDE / 2.0, .from = FREQUENCY, .to = 2.0 * FREQUENCY, .cycles = 2},
    };
    const md_programme programme = {.tick_rate = LINEAR_TICK_RATE, .ramp_cycles = 1, .blocks = blocks, .count = 2};
    md_rig_io io = {.context = &bench, .read = read_sensors, .drive = drive, .enable = NULL};
    wire(&wiring, 0.5);
    load_linear(&law);
    load_linear(&bench.specimen);
    CHECK(md_rig_init(&rig, &settings, &programme, &wiring, &io, &law, &problem) == MD_ERROR_NULL);
    io.enable = enable;
    CHECK(md_rig_tick(&rig, ticks, &seen) == MD_ERROR_NOT_INITIALIZED && bench.reads == 0);
    settings.force_limit = -1.0;
    CHECK(md_rig_init(&rig, &settings, &programme, &wiring, &io, &law, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(problem.field_length == 11 && memcmp(problem.field, "force_limit", 11) == 0 && problem.value == -1.0);
    settings.force_limit = 9.0;
    bench.enabled = true;
    CHECK(md_rig_init(&rig, &settings, &programme, &wiring, &io, &law, &problem) == MD_ERROR_NONE);
    CHECK(!bench.enabled);
    CHECK(md_rig_set_temperature(&rig, 20.0f) == MD_ERROR_NONE);
    check_controls();

    /* The whole programme. */
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE && bench.enabled);
    uint32_t cycles = 0;
    while (tick(), seen.state == MD_STATE_RUNNING) {
        if (seen.has_cycle && !seen.ramp && seen.block == 0 && seen.cycle > 2) {
            CHECK(is_near(seen.measured.stiffness, linear_stiffness(FREQUENCY), 1e-2));
            CHECK(is_near(seen.measured.loss_factor, linear_loss_factor(FREQUENCY), 1e-2));
            CHECK(is_near(seen.model.loss_factor, linear_loss_factor(FREQUENCY), 1e-2));
            CHECK(seen.nrmse < 0.05f);
            print_bits("rig's stiffness", seen.measured.stiffness);
            print_bits("rig's loss factor", seen.measured.loss_factor);
            cycles++;
        }
    }
    CHECK(cycles >= 2 && seen.state == MD_STATE_DONE && seen.trip == MD_TRIP_NONE);
    /* A start drives to the position of the piston. */
    CHECK(bench.drives == bench.reads + 1 && bench.reads == seen.tick);
    rest(settings.stop_ticks);
    CHECK(md_rig_clear_events(&rig) == MD_ERROR_NONE);

    /* A stop in the middle of the programme: the line drops within the call. */
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    for (int i = 0; i < 3000; i++)
        tick();
    CHECK(seen.state == MD_STATE_RUNNING && bench.position != 0.0f);
    CHECK(md_rig_stop(&rig) == MD_ERROR_NONE && !bench.enabled);
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_MOVING);
    rest(settings.stop_ticks);
    CHECK(seen.state == MD_STATE_IDLE);

    /* A missing reading: it trips in that tick, and runs again after a clear. */
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    bench.no_reading = true;
    tick();
    CHECK(seen.state == MD_STATE_FAULTED && seen.trip == MD_TRIP_ADC_BUS && !bench.enabled);
    bench.no_reading = false;
    rest(settings.stop_ticks);
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_FAULTED && problem.trip == MD_TRIP_ADC_BUS);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NO_FAULT);

    /* An actuator that accepts no command, and a line that does not rise. */
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    bench.no_drive = true;
    tick();
    CHECK(seen.trip == MD_TRIP_DAC_BUS);
    bench.no_drive = false;
    rest(settings.stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE);
    bench.no_enable = true;
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_FAULTED && problem.trip == MD_TRIP_ENABLE_LINE);
    bench.no_enable = false;
    rest(settings.stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE);

    /* A tick that came late. */
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_overrun(&rig) == MD_ERROR_NONE && !bench.enabled);
    CHECK(md_rig_tick(&rig, ticks++, NULL) == MD_ERROR_NONE);
    tick();
    CHECK(seen.trip == MD_TRIP_TICK_OVERRUN);

    /* A missing tick, and an external trip. */
    rest(settings.stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE && md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    tick();
    CHECK(seen.state == MD_STATE_RUNNING);
    uint32_t late = md_rig_late_ticks(&rig);
    ticks++;
    tick();
    CHECK(seen.trip == MD_TRIP_TICK_OVERRUN && !bench.enabled);
    CHECK(md_rig_late_ticks(&rig) == late + 1 && md_rig_late_ticks(NULL) == 0);
    CHECK(md_rig_keep_correction(&rig) == MD_ERROR_NONE && md_rig_keep_correction(NULL) == MD_ERROR_NULL);
    rest(settings.stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE && md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    CHECK(md_rig_external_trip(&rig) == MD_ERROR_NONE && !bench.enabled);
    tick();
    CHECK(seen.trip == MD_TRIP_EXTERNAL);

    /* A force channel that shows 0 V while its specimen moves: the monitor identifies the fault, and the rig trips. */
    rest(settings.stop_ticks);
    CHECK(md_rig_clear(&rig, &problem) == MD_ERROR_NONE && md_rig_exchange(&rig) == MD_ERROR_NONE);
    CHECK(md_rig_start(&rig, &problem) == MD_ERROR_NONE);
    for (int i = 0; i < 3000; i++)
        tick();
    md_expected any = {.tick_rate = 0.0f};
    uint8_t broken[1] = {0};
    CHECK(md_law_init(&bench.specimen, broken, 1, &any, NULL) == MD_ERROR_PACK_LENGTH);
    bool named = false;
    for (int i = 0; i < 3000 && seen.state == MD_STATE_RUNNING; i++) {
        tick();
        named = named || (seen.has_event && seen.event == MD_HEALTH_FORCE_DROPPED_OUT);
    }
    CHECK(named && seen.trip == MD_TRIP_FORCE_LOST);
    printf("rig: %s\n", md_trip_name(seen.trip));
    rest(settings.stop_ticks);
    check_load(&settings, &io);
    check_supervision(&settings, &programme, &io);
    printf("rig holds\n");
}
