/* Crowdquilt for engines: play a baked world of crowd patches, at any time, by random access.
 *
 * Metres, seconds, radians. Right-handed, y up; the ground is (x, z). Heading 0 looks along +z, a positive heading turns towards
 * +x. A world never changes: any number of threads may read it at once. Nothing is simulated: the state at a time is a function of
 * the time, so go back and forth as you like.
 *
 * Functions that fail return NULL, 0 or a negative number as noted, and cq_last_error() says why. No function aborts or throws.
 */
#ifndef CROWDQUILT_H
#define CROWDQUILT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A baked world (a *.world file). */
typedef struct cq_world cq_world;

/* Somebody near a camera. */
typedef struct cq_person {
    uint64_t id;      /* the same for the same person at any time */
    uint64_t look;    /* a well-mixed number that goes with the person: pick body and clothes by it */
    double x, z;      /* where it is */
    float vx, vz;     /* velocity, m/s */
    float heading;    /* where it looks */
    float speed;      /* length of the velocity, m/s */
    int32_t activity; /* what somebody who stays does, see cq_world_activity; -1 for those who walk */
    uint32_t patch;   /* patch, number and copy lead back to the person at the same time */
    uint32_t number;
    int32_t copy_x, copy_z; /* which copy of the world, where the world repeats */
} cq_person;

/* A joint's rotation relative to its parent's: a unit quaternion. */
typedef struct cq_quat {
    float x, y, z, w;
} cq_quat;

/* Message of the last error of this thread; empty if there was none. Valid until the thread's next error. */
const char *cq_last_error(void);

/* Read a world file; the path is UTF-8. NULL on error. Free it with cq_world_free. */
cq_world *cq_world_open(const char *path);

/* A world from the bytes of a world file, which are not needed afterwards. NULL on error. */
cq_world *cq_world_from_memory(const uint8_t *bytes, size_t size);

/* Free a world; NULL is nothing. */
void cq_world_free(cq_world *world);

/* Seconds after which everything repeats; 0 on error. */
double cq_world_period(const cq_world *world);

/* Radius of a body in metres; 0 on error. */
double cq_world_radius(const cq_world *world);

/* Least x, least z, greatest x, greatest z of the ground. 0, or -1 on error. */
int32_t cq_world_bounds(const cq_world *world, double out[4]);

/* 1 and the size in x and z of what repeats, if the world repeats for ever; 0 if it ends; -1 on error. */
int32_t cq_world_repeat(const cq_world *world, double out[2]);

/* 1 if people who walk have full bodies, 0 if not, -1 on error. */
int32_t cq_world_has_bodies(const cq_world *world);

/* What people who stay do, e.g. "talk"; NULL on error. Valid as long as the world. */
const char *cq_world_activity(const cq_world *world, int32_t activity);

/* Everybody within radius of (x, z) at a time: writes at most capacity people to out, and returns how many there are in all, or -1
 * on error. With capacity 0 out may be NULL. The order does not depend on anything but the arguments. */
ptrdiff_t cq_world_people(const cq_world *world, double secs, double x, double z, double radius, cq_person *out,
                          size_t capacity);

/* The body of somebody who walks and was found at the same time: the hips relative to (x, 0, z) of the person, and rotations of
 * cq_joint_count() joints, those of the hips included, which are turned with the person already. 0, or -1 on error. */
int32_t cq_world_pose(const cq_world *world, double secs, const cq_person *person, float hips[3], cq_quat *rotations);

/* The same as places: x, y, z of each joint relative to (x, 0, z) of the person. 0, or -1 on error. */
int32_t cq_world_joints(const cq_world *world, double secs, const cq_person *person, float *out);

/* How many joints a body has. */
size_t cq_joint_count(void);

/* The joint that a joint hangs on: always one before it; -1 for the hips, which are joint 0. */
int32_t cq_joint_parent(size_t joint);

#ifdef __cplusplus
}
#endif

#endif
