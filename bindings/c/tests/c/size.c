/* The size of a firmware that reads its law from a pack and calls it: only the output functions are linked in addition. Flash and RAM
 * are read from the file; stack and instructions are printed. */
#include <stddef.h>

#include "mesh_damper.h"
#include "stick_slip.h"

extern uint32_t bss_end[], stack_top[];

/* Calls of the emulator. */
#define SYS_WRITE0 4
#define SYS_EXIT 0x18
#define APPLICATION_EXIT 0x20026

static int call(int operation, const void *argument)
{
    register int r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;
    __asm volatile("bkpt #0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

/* The start-up code ends with this; nothing of newlib's own is linked. */
void exit(int status)
{
    call(SYS_EXIT, status == 0 ? (const void *)APPLICATION_EXIT : NULL);
    for (;;) {
    }
}

static void say(const char *name, uint32_t value)
{
    char digits[12];
    char *first = digits + sizeof digits - 1;
    *first = '\0';
    *--first = '\n';
    do {
        *--first = (char)('0' + value % 10u);
        value /= 10u;
    } while (value != 0u);
    call(SYS_WRITE0, name);
    call(SYS_WRITE0, first);
}

/* The core's timer: at 25 MHz it falls by 25.6 in the 2^10 ns of an instruction, so that the nearest whole number is the exact one. */
#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
#define PERIOD (1u << 24)

/* The same signature as md_law_force, so that both are called in the same way. */
static float nothing(md_law *law, const md_motion *motion)
{
    (void)law;
    return motion->displacement;
}

static float (*volatile measured)(md_law *, const md_motion *);

static uint32_t instructions(md_law *law, const md_motion *motion)
{
    float (*const function)(md_law *, const md_motion *) = measured;
    const uint32_t start = SYST_CVR;
    function(law, motion);
    const uint32_t fallen = (start - SYST_CVR) & (PERIOD - 1u);
    return (fallen * 5u + 64u) / 128u;
}

/* A word that marks unused places of the stack. */
#define PAINT 0xC5C5C5C5u
/* Number of bytes below the caller's stack frame that are left unchanged. */
#define MARGIN 64u

static uint32_t *here(void)
{
    uint32_t *pointer;
    __asm volatile("mov %0, sp" : "=r"(pointer));
    return pointer;
}

static void paint(void)
{
    for (volatile uint32_t *word = bss_end; word < here() - MARGIN / 4u; word++)
        *word = PAINT;
}

static uint32_t deepest(void)
{
    const volatile uint32_t *word = bss_end;
    while (*word == PAINT)
        word++;
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
}

static md_law law;

int main(void)
{
    paint();
    const md_expected expected = {.tick_rate = STICK_SLIP_TICK_RATE};
    if (md_law_init(&law, stick_slip_pack, STICK_SLIP_PACK_LENGTH, &expected, NULL) != MD_ERROR_NONE)
        return 1;
    SYST_RVR = PERIOD - 1u;
    SYST_CVR = 0;
    SYST_CSR = 5;
    md_motion motion = {.velocity = 2.0f};
    measured = nothing;
    const uint32_t overhead = instructions(&law, &motion);
    measured = md_law_force;
    /* A triangle of 0.1 mm. Each of the first ticks fills a row of a table; during the second thousand it is complete. */
    uint32_t filling = 0, most = 0, sum = 0;
    for (uint32_t n = 0; n < 2000u; n++) {
        const uint32_t place = n % 200u;
        motion.displacement = (place < 100u ? (float)place : 200.0f - (float)place) * 0.002f - 0.1f;
        motion.velocity = place < 100u ? 2.0f : -2.0f;
        const uint32_t count = instructions(&law, &motion) - overhead;
        if (n < 1000u) {
            filling = count > filling ? count : filling;
        } else {
            most = count > most ? count : most;
            sum += count;
        }
    }
    say("stack ", deepest());
    say("filling ", filling);
    say("longest ", most);
    say("mean ", (sum + 500u) / 1000u);
    return 0;
}
