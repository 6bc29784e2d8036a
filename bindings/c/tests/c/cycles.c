/* The sine generator against the sine, and both cycle accumulators against the closed form of a linear law. */
#include <math.h>

#include "check.h"

#define RATE ((double)LINEAR_TICK_RATE)
#define AMPLITUDE 0.1
#define FREQUENCY 5.0

static md_law law;
static md_sine sine;
static md_cycles cycles;
static md_crossings crossings;

static void check_refusals(void)
{
    md_problem problem;
    md_block blocks[MD_BLOCKS + 1];
    for (size_t i = 0; i < MD_BLOCKS + 1; i++)
        blocks[i] = (md_block){.amplitude = AMPLITUDE, .from = FREQUENCY, .to = 2.0 * FREQUENCY, .cycles = 2};
    CHECK(md_sine_init(&sine, RATE, 1, blocks, MD_BLOCKS, &problem) == MD_ERROR_NONE);
    CHECK(md_sine_init(&sine, RATE, 1, blocks, MD_BLOCKS + 1, &problem) == MD_ERROR_FULL);
    CHECK(problem.high == MD_BLOCKS);
    md_excitation now;
    CHECK(md_sine_tick(&sine, &now) == MD_ERROR_NOT_INITIALIZED);
    CHECK(md_sine_init(&sine, RATE, 1, blocks, 0, &problem) == MD_ERROR_EMPTY);
    blocks[0].amplitude = NAN;
    CHECK(md_sine_init(&sine, RATE, 1, blocks, 1, &problem) == MD_ERROR_NON_FINITE);
    CHECK(problem.field_length == 9 && memcmp(problem.field, "amplitude", 9) == 0);
    blocks[0] = (md_block){.amplitude = AMPLITUDE, .from = RATE, .to = RATE, .cycles = 2};
    CHECK(md_sine_init(&sine, RATE, 1, blocks, 1, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(problem.value == RATE && problem.high < RATE);
    CHECK(md_sine_init(NULL, RATE, 1, blocks, 1, &problem) == MD_ERROR_NULL);
    CHECK(md_sine_restart(NULL) == MD_ERROR_NULL);
    CHECK(md_crossings_init(&crossings, -1.0f, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(md_cycles_init(NULL) == MD_ERROR_NULL);
}

static void check_cycle(const md_cycle *cycle)
{
    CHECK(is_near(cycle->amplitude, AMPLITUDE, 1e-5));
    CHECK(is_near(cycle->ticks, RATE / FREQUENCY, 1e-5));
    CHECK(is_near(cycle->energy, PI * C * 2.0 * PI * FREQUENCY * AMPLITUDE * AMPLITUDE, 1e-4));
    CHECK(is_near(cycle->stiffness, linear_stiffness(FREQUENCY), 1e-4));
    CHECK(is_near(cycle->loss_factor, linear_loss_factor(FREQUENCY), 1e-4));
    print_bits("stiffness", cycle->stiffness);
    print_bits("loss factor", cycle->loss_factor);
}

void check_cycles(void)
{
    check_refusals();
    load_linear(&law);
    const md_block block = {.amplitude = AMPLITUDE, .from = FREQUENCY, .to = FREQUENCY, .cycles = 6};
    CHECK(md_sine_init(&sine, RATE, 1, &block, 1, NULL) == MD_ERROR_NONE);
    CHECK(md_cycles_init(&cycles) == MD_ERROR_NONE);
    CHECK(md_crossings_init(&crossings, 0.01f, NULL) == MD_ERROR_NONE);
    uint32_t ended = 0, crossed = 0, steady = 0;
    for (int again = 0; again < 2; again++) {
        for (uint32_t tick = 0;; tick++) {
            md_excitation now;
            CHECK(md_sine_tick(&sine, &now) == MD_ERROR_NONE);
            if (now.done)
                break;
            if (!now.ramp) {
                const double angle = 2.0 * PI * FREQUENCY * tick / RATE;
                const double speed = 2.0 * PI * FREQUENCY * AMPLITUDE;
                CHECK(fabs(now.displacement - AMPLITUDE * sin(angle)) < 1e-6 * AMPLITUDE);
                CHECK(fabs(now.velocity - speed * cos(angle)) < 1e-6 * speed);
                steady++;
            }
            const md_motion motion = {.displacement = now.displacement, .velocity = now.velocity};
            const float force = md_law_force(&law, &motion);
            md_cycle results = {.ticks = -1.0f};
            if (md_cycles_update(&cycles, now.displacement, force, now.phase, &results)) {
                /* The first and the last cycle are the ramps. */
                if (!now.ramp && now.cycle > 1)
                    check_cycle(&results), ended++;
            } else {
                CHECK(results.ticks == -1.0f);
            }
            if (md_crossings_update(&crossings, now.displacement, force, &results) && now.cycle > 3 && now.cycle < 7)
                check_cycle(&results), crossed++;
        }
        CHECK(md_sine_restart(&sine) == MD_ERROR_NONE);
        CHECK(md_cycles_init(&cycles) == MD_ERROR_NONE);
        CHECK(md_crossings_init(&crossings, 0.01f, NULL) == MD_ERROR_NONE);
    }
    CHECK(ended >= 10 && crossed >= 4 && steady == 2 * 6 * (uint32_t)(RATE / FREQUENCY));
    CHECK(!md_cycles_update(NULL, 0.0f, 0.0f, 0, NULL) && !md_crossings_update(NULL, 0.0f, 0.0f, NULL));
    printf("cycles hold\n");
}
