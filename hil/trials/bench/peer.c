/* The whole tick in plain C on newlib's sinf, cosf and powf, and powf alone: what `firmware/src/bench/suite/naive.rs` is in
 * Rust, line by line, and counted the same way. */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TAU 6.28318531f

struct sample {
    float displacement, force;
};

/* Trapezoids over the cycle so far, without their factor 1/2. */
struct sums {
    float energy, force_max, force_min;
};

struct cycle {
    float force_max, force_min, displacement_max, displacement_min;
    float amplitude, energy, energy_harmonic, stiffness, elastic_energy, loss_factor;
};

struct tick {
    uint32_t phase, step;
    float amplitude, angular;
    float k1, k3, c, alpha;
    struct sample last;
    struct sums sums;
    bool begun, ended;
    struct cycle cycle;
};

static struct sums start(struct sample at)
{
    return (struct sums){
        .force_max = at.force,
        .force_min = at.force,
    };
}

static inline void add(struct sums *s, struct sample a, struct sample b)
{
    s->energy += (a.force + b.force) * (b.displacement - a.displacement);
    if (b.force > s->force_max)
        s->force_max = b.force;
    if (b.force < s->force_min)
        s->force_min = b.force;
}

static struct cycle finish(const struct sums *s, float amplitude)
{
    float range = s->force_max - s->force_min;
    float energy = 0.5f * s->energy;
    float elastic_energy = 0.25f * range * amplitude;
    return (struct cycle){
        .force_max = s->force_max,
        .force_min = s->force_min,
        .displacement_max = amplitude,
        .displacement_min = -amplitude,
        .amplitude = amplitude,
        .energy = energy,
        .energy_harmonic = energy,
        .stiffness = range / (2.0f * amplitude),
        .elastic_energy = elastic_energy,
        .loss_factor = energy / (TAU * elastic_energy),
    };
}

static float whole(void *context, float a, float b)
{
    struct tick *t = context;
    (void)a, (void)b;
    float theta = (float)t->phase * (TAU / 4294967296.0f);
    float s = sinf(theta), c = cosf(theta);
    float y = t->amplitude * s;
    float v = t->amplitude * t->angular * c;
    float damping = t->c * powf(fabsf(v), t->alpha);
    float force = t->k1 * y + t->k3 * y * y * y + (v < 0.0f ? -damping : damping);
    struct sample now = { y, force };
    t->ended = false;
    if (!t->begun) {
        t->begun = true;
        t->sums = start(now);
    } else if (t->phase < t->step) {
        /* The cycle ended between the last tick and this one. */
        float part = 1.0f - (float)t->phase / (float)t->step;
        struct sample middle = {
            t->last.displacement + part * (y - t->last.displacement),
            t->last.force + part * (force - t->last.force),
        };
        add(&t->sums, t->last, middle);
        t->cycle = finish(&t->sums, t->amplitude);
        t->ended = true;
        t->sums = start(middle);
        add(&t->sums, middle, now);
    } else {
        add(&t->sums, t->last, now);
    }
    t->last = now;
    t->phase += t->step;
    return force;
}

static float power(void *context, float v, float alpha)
{
    (void)context;
    return powf(fabsf(v), alpha);
}

static float empty(void *context, float a, float b)
{
    (void)context, (void)b;
    return a;
}

/* Counting, as in firmware/src/bench/counter.rs. */

#define SYST_CSR (*(volatile uint32_t *)0xe000e010)
#define SYST_RVR (*(volatile uint32_t *)0xe000e014)
#define SYST_CVR (*(volatile uint32_t *)0xe000e018)
#define PERIOD (1u << 24)
#define CLOCK 25u /* MHz */

typedef float (*region)(void *, float, float);

static uint32_t overhead;

static __attribute__((noinline, noipa)) uint32_t timed(region r, void *context, float a, float b, float *result)
{
    uint32_t start = SYST_CVR;
    *result = r(context, a, b);
    uint32_t end = SYST_CVR;
    return (start - end) % PERIOD;
}

struct tally {
    uint32_t calls, sum, least, most, checksum;
};

#define NO_CALLS { 0, 0, UINT32_MAX, 0, 0x811c9dc5u }

static void include(struct tally *t, float result)
{
    union { float value; uint32_t bits; } word = { result };
    t->checksum = (t->checksum ^ word.bits) * 0x01000193u;
}

static uint32_t call(region r, void *context, float a, float b, float *result)
{
    uint32_t ticks = timed(r, context, a, b, result);
    return (ticks * 125u + CLOCK * 64u) / (CLOCK * 128u) - overhead;
}

static void count(struct tally *t, uint32_t instructions, float result)
{
    t->calls++;
    t->sum += instructions;
    if (instructions < t->least)
        t->least = instructions;
    if (instructions > t->most)
        t->most = instructions;
    include(t, result);
}

/* Output by semihosting. */

static void semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt #0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void print(const char *text)
{
    semihosting(0x04, text);
}

static void print_number(uint32_t value, uint32_t base)
{
    char digits[12];
    char *at = digits + sizeof digits - 1;
    *at = 0;
    do {
        *--at = "0123456789abcdef"[value % base];
        value /= base;
    } while (value);
    print(" ");
    print(at);
}

static void report(const char *name, const struct tally *t)
{
    print(name);
    print_number(t->calls, 10);
    print_number(t->sum, 10);
    print_number(t->least, 10);
    print_number(t->most, 10);
    print_number(t->checksum, 16);
    print("\n");
}

static void print_float(float value)
{
    union { float value; uint32_t bits; } word = { value };
    print_number(word.bits, 16);
}

/* The inputs come from the harness, which shares them with the image in Rust: ALPHAS, VELOCITIES, LAWS and the like. */
#include "inputs.h"

static const float alphas[] = { ALPHAS };

static const struct {
    float amplitude, k1, k3, c, alpha;
} laws[] = { LAWS };

static float velocity(uint32_t index)
{
    union { uint32_t bits; float value; } word = {
        VELOCITY_LOW + (uint32_t)((uint64_t)(VELOCITY_HIGH - VELOCITY_LOW) * index / (VELOCITIES - 1))
    };
    return word.value;
}

int main(void)
{
    SYST_RVR = PERIOD - 1;
    SYST_CVR = 0;
    SYST_CSR = 5; /* on, the core's clock */
    float result;
    overhead = call(empty, NULL, 0.0f, 0.0f, &result);

    struct tally powers = NO_CALLS;
    for (size_t i = 0; i < sizeof alphas / sizeof *alphas; i++)
        for (uint32_t j = 0; j < VELOCITIES; j++) {
            uint32_t n = call(power, NULL, velocity(j), alphas[i], &result);
            count(&powers, n, result);
        }
    report("power/c call", &powers);

    struct tally steady = NO_CALLS, ends = NO_CALLS;
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        struct tick t = {
            .step = STEP,
            .amplitude = laws[i].amplitude,
            .angular = ANGULAR,
            .k1 = laws[i].k1,
            .k3 = laws[i].k3,
            .c = laws[i].c,
            .alpha = laws[i].alpha,
        };
        for (uint32_t j = 0; j < TICKS; j++) {
            uint32_t n = call(whole, &t, 0.0f, 0.0f, &result);
            if (t.ended) {
                count(&ends, n, result);
                include(&ends, t.cycle.stiffness);
                include(&ends, t.cycle.energy);
                include(&ends, t.cycle.loss_factor);
            } else {
                count(&steady, n, result);
            }
        }
        /* The last cycle's results, so that it can be seen that this computes the same. */
        print("= tick/c");
        print_float(t.cycle.stiffness);
        print_float(t.cycle.energy);
        print_float(t.cycle.loss_factor);
        print("\n");
    }
    report("tick/c steady", &steady);
    report("tick/c cycle-end", &ends);
    semihosting(0x18, (const void *)0x20026);
    for (;;)
        ;
}

/* From reset to main. */

extern uint32_t stack_top, data_start, data_end, data_load, bss_start, bss_end;

void reset(void)
{
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20; /* the floating-point unit on */
    __asm__ volatile("dsb\n isb");
    for (uint32_t *to = &data_start, *from = &data_load; to < &data_end;)
        *to++ = *from++;
    for (uint32_t *to = &bss_start; to < &bss_end;)
        *to++ = 0;
    main();
}

__attribute__((section(".vectors"), used)) static const void *const vectors[] = { &stack_top, reset };
