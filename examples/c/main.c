/* A damper's law in a timer interrupt: the motion of a sine generator goes in, the force of the law in mount.c comes out, and each
 * cycle's stiffness and loss factor are printed. On a rig the motion comes from a sensor, and the force goes to an actuator. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "mesh_damper.h"
#include "mount.h"

/* Ticks per second of this firmware, Hz. A pack for another rate is refused: export the model with --tick-rate. */
#define TICK_RATE 10000u

/* The core's timer, at the 25 MHz of this board. */
#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
#define ICSR (*(volatile uint32_t *)0xE000ED04u)
#define SYSTICK_PENDING (1u << 26)
#define CORE_CLOCK 25000000u

/* newlib's files, which the emulator provides. */
void initialise_monitor_handles(void);

static md_law law;
static md_sine sine;
static md_cycles cycles;

/* The compiler moves no access to memory across it. The core itself has one view of its memory, in the interrupt and in main. */
#define BARRIER() __asm volatile("" ::: "memory")

/* From the interrupt to main: written while `ready` is false, read while it is true, with a barrier between `ready` and these. */
static md_cycle results;
static uint32_t number;
static volatile bool ready, done;
/* Error of the generator: MD_ERROR_NONE as long as there is a motion. */
static volatile md_error failed;
/* Cycles for which main was too slow, and ticks that came before the previous one had ended. */
static volatile uint32_t lost, late;

void systick(void);

/* Called TICK_RATE times a second. */
void systick(void)
{
    md_excitation now;
    const md_error error = md_sine_tick(&sine, &now);
    if (error != MD_ERROR_NONE || now.done) {
        failed = error;
        done = true;
        return;
    }
    /* ANCHOR: tick */
    const md_motion motion = {
        .displacement = now.displacement,
        .velocity = now.velocity,
        .acceleration = now.acceleration,
        .temperature = 20.0f,
    };
    const float force = md_law_force(&law, &motion);
    /* ANCHOR_END: tick */
    md_cycle cycle;
    if (md_cycles_update(&cycles, now.displacement, force, now.phase, &cycle)) {
        if (ready) {
            lost++;
        } else {
            BARRIER();
            results = cycle;
            number = now.cycle;
            BARRIER();
            ready = true;
        }
    }
    if (ICSR & SYSTICK_PENDING)
        late++;
}

/* Prints the error and its remedy, and ends the program. */
static void require(md_error error, const md_problem *problem)
{
    if (error == MD_ERROR_NONE)
        return;
    printf("%s: %s\n", md_error_name(error), md_error_help(error));
    if (problem->field != NULL)
        printf("%.*s = %g is not within %g to %g\n", (int)problem->field_length, problem->field, problem->value, problem->low,
               problem->high);
    exit(EXIT_FAILURE);
}

int main(void)
{
    initialise_monitor_handles();
    md_problem problem;
    const md_expected expected = {.tick_rate = (float)TICK_RATE};
    require(md_law_init(&law, mount_pack, MOUNT_PACK_LENGTH, &expected, &problem), &problem);

    /* Three cycles of 0.1 mm at 5 Hz, and a ramp of one cycle before and after. */
    const md_block block = {.amplitude = 0.1, .from = 5.0, .to = 5.0, .cycles = 3};
    require(md_sine_init(&sine, TICK_RATE, 1, &block, 1, &problem), &problem);
    require(md_cycles_init(&cycles), &problem);

    printf("%s at %lu Hz\n", MOUNT_NAME, (unsigned long)TICK_RATE);
    SYST_RVR = CORE_CLOCK / TICK_RATE - 1u;
    SYST_CVR = 0;
    SYST_CSR = 7; /* On, with its interrupt, by the core's clock. */
    while (!done || ready) {
        if (!ready) {
            __asm volatile("wfi" ::: "memory");
            continue;
        }
        BARRIER();
        printf("cycle %lu: stiffness %.4f kN/mm, loss factor %.4f\n", (unsigned long)number, (double)results.stiffness,
               (double)results.loss_factor);
        BARRIER();
        ready = false;
    }
    problem = (md_problem){.error = failed};
    require(failed, &problem);
    printf("%lu ticks late, %lu cycles lost\n", (unsigned long)late, (unsigned long)lost);
    return late == 0 && lost == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
