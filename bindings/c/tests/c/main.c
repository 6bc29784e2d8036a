/* Every function of the library, on this machine and on the emulated board. The output must be the same on both. */
#include <math.h>

#include "check.h"

#ifdef __arm__
void initialise_monitor_handles(void);
#endif

/* The constants equal those of the types. */
#define IS_SIZE(type, size, align) \
    typedef char type##_has_its_size[sizeof(type) >= (size) && sizeof(type) < (size) + (align) ? 1 : -1]; \
    struct type##_behind_a_byte { \
        char byte; \
        type value; \
    }; \
    typedef char type##_has_its_alignment[offsetof(struct type##_behind_a_byte, value) == (align) ? 1 : -1]

IS_SIZE(md_law, MD_LAW_SIZE, MD_LAW_ALIGN);
IS_SIZE(md_cycles, MD_CYCLES_SIZE, MD_CYCLES_ALIGN);
IS_SIZE(md_crossings, MD_CROSSINGS_SIZE, MD_CROSSINGS_ALIGN);
IS_SIZE(md_sine, MD_SINE_SIZE, MD_SINE_ALIGN);
IS_SIZE(md_scale, MD_SCALE_SIZE, MD_SCALE_ALIGN);
IS_SIZE(md_emulation, MD_EMULATION_SIZE, MD_EMULATION_ALIGN);
IS_SIZE(md_rig, MD_RIG_SIZE, MD_RIG_ALIGN);

double linear_stiffness(double frequency)
{
    const double loss = C * 2.0 * PI * frequency;
    return sqrt(K1 * K1 + loss * loss);
}

double linear_loss_factor(double frequency)
{
    return C * 2.0 * PI * frequency / linear_stiffness(frequency);
}

void load_linear(md_law *law)
{
    const md_expected expected = {.tick_rate = LINEAR_TICK_RATE};
    CHECK(md_law_init(law, linear_pack, LINEAR_PACK_LENGTH, &expected, NULL) == MD_ERROR_NONE);
}

void wire(md_wiring *wiring, double command)
{
    CHECK(md_scale_init(&wiring->displacement, 0.5, 0.0, NULL) == MD_ERROR_NONE);
    CHECK(md_scale_init(&wiring->force, 10.0, 0.0, NULL) == MD_ERROR_NONE);
    CHECK(md_scale_init(&wiring->command, command, 0.0, NULL) == MD_ERROR_NONE);
}

int main(void)
{
#ifdef __arm__
    initialise_monitor_handles();
#endif
    check_packs();
    check_cycles();
    check_converters();
    check_emulation();
    check_rig();
    printf("all checks hold\n");
    return EXIT_SUCCESS;
}
