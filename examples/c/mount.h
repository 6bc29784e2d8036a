/* Written by `hil export` of mesh-damper 0.1.0. Export the model again instead of changing this. */
#ifndef MESH_DAMPER_PACK_MOUNT_H
#define MESH_DAMPER_PACK_MOUNT_H

#include <stdint.h>

/* Name of the model. */
#define MOUNT_NAME "mount"
/* Revision of this export. */
#define MOUNT_REVISION 0u
/* Ticks per second that the law is for, Hz. */
#define MOUNT_TICK_RATE 10000.0f
/* Bytes of the pack. */
#define MOUNT_PACK_LENGTH 338u

#ifdef __cplusplus
extern "C" {
#endif

/* The coefficient pack. */
extern const uint8_t mount_pack[MOUNT_PACK_LENGTH];
/* Identity of the model. */
extern const uint8_t mount_identity[8];
/* Displacement in mm of the motion that it was fitted on: least and largest. */
extern const float mount_displacement[2];
/* Velocity in mm/s of the motion that it was fitted on: least and largest. */
extern const float mount_velocity[2];

#ifdef __cplusplus
}
#endif

#endif
