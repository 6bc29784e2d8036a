/* Shared by the checks. A check that fails reports its place, and ends the program. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "linear.h"
#include "mesh_damper.h"
#include "mount.h"
#include "active.h"
#include "silent.h"

#define CHECK(what) \
    do { \
        if (!(what)) { \
            printf("%s:%d: %s does not hold\n", __FILE__, __LINE__, #what); \
            exit(EXIT_FAILURE); \
        } \
    } while (0)

/* The bits of a number, which are the same on every machine. */
static inline void print_bits(const char *name, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    printf("%s %08lx\n", name, (unsigned long)bits);
}

static inline int is_near(double value, double expected, double part)
{
    const double off = value > expected ? value - expected : expected - value;
    return off <= part * (expected < 0.0 ? -expected : expected);
}

/* The law of linear.c: K1 in kN/mm and C in kN*s/mm, whose loss factor has a closed form. */
#define K1 10.0
#define C 0.05
#define PI 3.14159265358979323846

/* F = K1*y + C*v over y = A*sin(w*t): the stiffness is sqrt(K1^2 + (C*w)^2). */
double linear_stiffness(double frequency);
/* Its energy is pi*C*w*A^2, and the loss factor C*w over the stiffness. */
double linear_loss_factor(double frequency);

/* Loads linear.c. */
void load_linear(md_law *law);
/* Full scales of 0.5 mm, 10 kN, and a separate one for the command. */
void wire(md_wiring *wiring, double command);

void check_packs(void);
void check_cycles(void);
void check_converters(void);
void check_emulation(void);
void check_rig(void);

#endif
