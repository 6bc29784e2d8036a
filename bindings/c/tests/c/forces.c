/* The forces of the law in mount.c over the motions of a file. Each record of motions.bin is a motion, and each record of forces.bin
 * is a force, in their layout in memory. */
#include <stdio.h>
#include <stdlib.h>

#include "mesh_damper.h"
#include "mount.h"

#ifdef __arm__
void initialise_monitor_handles(void);
#endif

static md_law law;

int main(void)
{
#ifdef __arm__
    initialise_monitor_handles();
#endif
    const md_expected expected = {.tick_rate = MOUNT_TICK_RATE, .identity = mount_identity};
    md_problem problem;
    if (md_law_init(&law, mount_pack, MOUNT_PACK_LENGTH, &expected, &problem) != MD_ERROR_NONE) {
        printf("%s: %s\n", md_error_name(problem.error), md_error_help(problem.error));
        return EXIT_FAILURE;
    }
    FILE *motions = fopen("motions.bin", "rb");
    FILE *forces = fopen("forces.bin", "wb");
    if (motions == NULL || forces == NULL)
        return EXIT_FAILURE;
    md_motion motion;
    unsigned long ticks = 0;
    while (fread(&motion, sizeof motion, 1, motions) == 1) {
        const float force = md_law_force(&law, &motion);
        if (fwrite(&force, sizeof force, 1, forces) != 1)
            return EXIT_FAILURE;
        ticks++;
    }
    printf("%lu ticks\n", ticks);
    return fclose(forces) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
