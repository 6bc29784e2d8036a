/* The damper emulation: it drives the law's force for the measured motion, and trips for each cause. */
#include "check.h"

#define AMPLITUDE 0.1
#define FREQUENCY 2.0

static md_law law;
static md_sine sine;
static md_emulation emulation;
static md_wiring wiring;
static md_telemetry seen;

/* The control inputs of each reading. */
static float controls[MD_CONTROLS];

/* Ticks so far, which serve as the clock. */
static uint32_t ticks;

/* One tick at `displacement` mm and `force` kN. */
static void tick(float displacement, float force)
{
    md_reading reading = {
        .displacement = md_scale_decode(&wiring.displacement, 16, md_scale_encode(&wiring.displacement, displacement)),
        .force = md_scale_decode(&wiring.force, 16, md_scale_encode(&wiring.force, force)),
    };
    memcpy(reading.controls, controls, sizeof controls);
    CHECK(md_emulation_tick(&emulation, &reading, ticks++, &seen) == MD_ERROR_NONE);
    CHECK(memcmp(seen.controls, controls, sizeof controls) == 0);
}

/* At rest until the command is back at 0. */
static void rest(uint32_t stop_ticks)
{
    for (uint32_t i = 0; i < stop_ticks + 2; i++)
        tick(0.0f, 0.0f);
    CHECK(seen.command == 0.0f && !seen.enabled);
}

/* Another law while it runs: the running law continues until its cycle ends, and then the other law takes over. */
static void check_load(void)
{
    const md_expected expected = {.tick_rate = LINEAR_TICK_RATE};
    md_emulation_settings settings;
    md_problem problem;
    CHECK(md_law_init(&law, mount_pack, MOUNT_PACK_LENGTH, &expected, NULL) == MD_ERROR_NONE);
    CHECK(md_emulation_defaults(&settings) == MD_ERROR_NONE);
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, NULL) == MD_ERROR_NONE);
    tick(0.0f, 0.0f);
    CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
    const md_block block = {.amplitude = AMPLITUDE, .from = FREQUENCY, .to = FREQUENCY, .cycles = 12};
    CHECK(md_sine_init(&sine, LINEAR_TICK_RATE, 1, &block, 1, NULL) == MD_ERROR_NONE);
    uint32_t others = 0, after = 0, linear = 0;
    float driven = 0.0f;
    bool loaded = false;
    for (;;) {
        md_excitation now;
        CHECK(md_sine_tick(&sine, &now) == MD_ERROR_NONE);
        if (now.done)
            break;
        tick(now.displacement, driven);
        driven = seen.command;
        /* Between two ticks, in the middle of a cycle. A pack that is refused changes nothing. */
        if (!loaded && others == 2 && now.displacement > 0.05f) {
            CHECK(md_law_load(&law, linear_pack, LINEAR_PACK_LENGTH - 1, &expected, &problem) == MD_ERROR_PACK_LENGTH);
            CHECK(md_law_load(&law, linear_pack, LINEAR_PACK_LENGTH, &expected, &problem) == MD_ERROR_NONE);
            loaded = true;
        }
        if (seen.has_cycle && now.cycle > 2 && !now.ramp) {
            const int is_linear = is_near(seen.model.stiffness, linear_stiffness(FREQUENCY), 2e-3);
            /* The cycle of the load still belongs to the previous law. */
            after += loaded;
            CHECK(is_linear == (after > 1));
            others += !is_linear;
            linear += is_linear;
        }
    }
    CHECK(others >= 3 && linear >= 2);
    printf("a law loaded while the emulation runs drives %lu cycles\n", (unsigned long)linear);
}

void check_emulation(void)
{
    md_emulation_settings settings;
    md_problem problem;
    CHECK(md_emulation_defaults(&settings) == MD_ERROR_NONE);
    settings.tick_rate = LINEAR_TICK_RATE;
    settings.stop_ticks = 500;
    static md_wiring not_wired;
    load_linear(&law);
    CHECK(md_emulation_init(&emulation, &settings, &not_wired, &law, &problem) == MD_ERROR_NOT_INITIALIZED);
    wire(&wiring, 10.0);
    settings.trip_ticks = 0;
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(problem.field_length == 10 && memcmp(problem.field, "trip_ticks", 10) == 0 && problem.low == 1.0);
    CHECK(md_emulation_tick(&emulation, NULL, ticks, &seen) == MD_ERROR_NOT_INITIALIZED);
    settings.trip_ticks = 10;
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, &problem) == MD_ERROR_NONE);
    CHECK(md_emulation_set_temperature(&emulation, 25.0f) == MD_ERROR_NONE);
    for (int i = 0; i < MD_CONTROLS; i++)
        controls[i] = 0.5f + (float)i;

    CHECK(md_emulation_start(&emulation, &problem) == MD_ERROR_NONE);
    CHECK(md_emulation_start(&emulation, &problem) == MD_ERROR_RUNNING);
    const md_block block = {.amplitude = AMPLITUDE, .from = FREQUENCY, .to = FREQUENCY, .cycles = 6};
    CHECK(md_sine_init(&sine, LINEAR_TICK_RATE, 1, &block, 1, NULL) == MD_ERROR_NONE);
    uint32_t cycles = 0;
    float driven = 0.0f;
    for (;;) {
        md_excitation now;
        CHECK(md_sine_tick(&sine, &now) == MD_ERROR_NONE);
        if (now.done)
            break;
        /* The actuator follows the command. */
        tick(now.displacement, driven);
        CHECK(seen.state == MD_STATE_RUNNING && seen.enabled && seen.trip == MD_TRIP_NONE);
        driven = seen.command;
        if (seen.has_cycle && now.cycle > 3 && !now.ramp) {
            /* The observer of 100 Hz lags by (1 + 2*0.7)*(2/100)^2 of the velocity. */
            CHECK(is_near(seen.model.stiffness, linear_stiffness(FREQUENCY), 2e-3));
            CHECK(is_near(seen.model.loss_factor, linear_loss_factor(FREQUENCY), 2e-2));
            CHECK(is_near(seen.measured.loss_factor, seen.model.loss_factor, 2e-2));
            print_bits("emulation's stiffness", seen.measured.stiffness);
            print_bits("emulation's loss factor", seen.measured.loss_factor);
            cycles++;
        }
    }
    CHECK(cycles >= 2);

    CHECK(md_emulation_stop(&emulation) == MD_ERROR_NONE);
    tick(0.0f, 0.0f);
    CHECK(seen.state == MD_STATE_IDLE && !seen.enabled);
    CHECK(md_emulation_start(&emulation, &problem) == MD_ERROR_MOVING);
    rest(settings.stop_ticks);
    CHECK(md_emulation_clear(&emulation, &problem) == MD_ERROR_NO_FAULT);

    /* A missing reading trips it in that tick; only a clear at rest ends the trip. */
    CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
    CHECK(md_emulation_tick(&emulation, NULL, ticks++, &seen) == MD_ERROR_NONE);
    CHECK(seen.state == MD_STATE_FAULTED && seen.trip == MD_TRIP_ADC_BUS && !seen.enabled);
    rest(settings.stop_ticks);
    CHECK(md_emulation_start(&emulation, &problem) == MD_ERROR_FAULTED && problem.trip == MD_TRIP_ADC_BUS);
    CHECK(md_emulation_clear(&emulation, &problem) == MD_ERROR_NONE);

    /* Beyond the limit for trip_ticks consecutive ticks. */
    CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
    settings.displacement_limit = 0.05;
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, NULL) == MD_ERROR_NONE);
    tick(0.0f, 0.0f);
    CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
    for (uint32_t i = 0; i < settings.trip_ticks; i++) {
        CHECK(seen.state != MD_STATE_FAULTED);
        tick(0.054f, 0.0f);
    }
    CHECK(seen.state == MD_STATE_FAULTED && seen.trip == MD_TRIP_DISPLACEMENT_LIMIT);
    printf("emulation: %s\n", md_trip_name(seen.trip));

    /* The caller reports what failed. */
    const struct {
        md_error (*fail)(md_emulation *);
        md_trip trip;
    } failures[] = {
        {md_emulation_command_failed, MD_TRIP_DAC_BUS},
        {md_emulation_command_unverified, MD_TRIP_DAC_BUS},
        {md_emulation_enable_failed, MD_TRIP_ENABLE_LINE},
        {md_emulation_overrun, MD_TRIP_TICK_OVERRUN},
        {md_emulation_external_trip, MD_TRIP_EXTERNAL},
    };
    for (size_t i = 0; i < sizeof failures / sizeof failures[0]; i++) {
        rest(settings.stop_ticks);
        CHECK(md_emulation_clear(&emulation, NULL) == MD_ERROR_NONE);
        CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
        tick(0.0f, 0.0f);
        CHECK(failures[i].fail(&emulation) == MD_ERROR_NONE);
        tick(0.0f, 0.0f);
        CHECK(seen.trip == failures[i].trip);
    }

    /* A missing tick, and a tick that comes twice. */
    for (uint32_t missing = 0; missing < 2; missing++) {
        rest(settings.stop_ticks);
        CHECK(md_emulation_clear(&emulation, NULL) == MD_ERROR_NONE);
        CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
        tick(0.0f, 0.0f);
        CHECK(seen.state == MD_STATE_RUNNING);
        uint32_t late = md_emulation_late_ticks(&emulation);
        ticks = missing ? ticks + 1 : ticks - 1;
        tick(0.0f, 0.0f);
        CHECK(seen.trip == MD_TRIP_TICK_OVERRUN && !seen.enabled);
        CHECK(md_emulation_late_ticks(&emulation) == late + 1 && md_emulation_late_ticks(NULL) == 0);
    }
    settings.clock_rate = 0.5 * LINEAR_TICK_RATE;
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(problem.field_length == 10 && memcmp(problem.field, "clock_rate", 10) == 0 && problem.low == LINEAR_TICK_RATE);
    settings.clock_rate = 0.0;

    /* A lost link. */
    settings.link_ticks = 20;
    CHECK(md_emulation_init(&emulation, &settings, &wiring, &law, NULL) == MD_ERROR_NONE);
    tick(0.0f, 0.0f);
    CHECK(md_emulation_start(&emulation, NULL) == MD_ERROR_NONE);
    for (uint32_t i = 0; i < 100; i++) {
        CHECK(md_emulation_exchange(&emulation) == MD_ERROR_NONE);
        tick(0.0f, 0.0f);
        CHECK(seen.state == MD_STATE_RUNNING);
    }
    for (uint32_t i = 0; i < 21; i++)
        tick(0.0f, 0.0f);
    CHECK(seen.trip == MD_TRIP_LINK_LOST);
    check_load();
    printf("emulation holds\n");
}
