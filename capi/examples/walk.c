/* Who is near a camera that walks along a world? Compile, from the root of the project:
 *
 *     cargo build --release -p crowdquilt-capi
 *     cc capi/examples/walk.c -Icapi/include -Ltarget/release -lcrowdquilt_capi -lm -o walk
 *     LD_LIBRARY_PATH=target/release ./walk city.world
 */
#include "crowdquilt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 256 };

/* What an engine does once for every frame. */
static int frame(const cq_world *world, double secs, double x, double z) {
    cq_person people[MOST];
    ptrdiff_t found = cq_world_people(world, secs, x, z, 12.0, people, MOST);
    if (found < 0) return 1;
    size_t count = found < MOST ? (size_t)found : MOST, walking = 0;
    double highest = 0.0;
    float *joints = malloc(3 * cq_joint_count() * sizeof *joints);
    for (size_t i = 0; i < count; i++) {
        if (people[i].activity >= 0) continue;
        walking++;
        if (cq_world_has_bodies(world) != 1) continue;
        if (cq_world_joints(world, secs, &people[i], joints) != 0) return 1;
        for (size_t j = 0; j < cq_joint_count(); j++) highest = fmax(highest, joints[3 * j + 1]);
    }
    free(joints);
    printf("%5.2f s: camera at (%.1f, %.1f), %zu walk", secs, x, z, walking);
    if (count > walking) printf(", %zu stay", count - walking);
    if (highest > 0.0) printf(", the tallest joint is %.2f m high", highest);
    if (count > 0) printf(", %016llx walks %.2f m/s", (unsigned long long)people[0].id, people[0].speed);
    printf("\n");
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: walk WORLD\n");
        return 2;
    }
    cq_world *world = cq_world_open(argv[1]);
    double bounds[4];
    if (!world || cq_world_bounds(world, bounds) != 0) {
        fprintf(stderr, "%s\n", cq_last_error());
        return 1;
    }
    double period = cq_world_period(world), z = 0.5 * (bounds[1] + bounds[3]);
    printf("period %.1f s, from (%.1f, %.1f) to (%.1f, %.1f)\n", period, bounds[0], bounds[1], bounds[2], bounds[3]);
    int failed = 0;
    for (int i = 0; i < 10 && !failed; i++) failed = frame(world, 0.3 * i * period, bounds[0] + 1.3 * 0.3 * i * period, z);
    if (failed) fprintf(stderr, "%s\n", cq_last_error());
    cq_world_free(world);
    return failed;
}
