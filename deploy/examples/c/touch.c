/* Presses a tool into a body and out again, in a 1 kHz loop, and computes each force that a haptic
 * device would get.
 *
 *   touch DATASET.h5 [DEPTH_MM]
 *
 * Build, with libpalpate installed:
 *   cc -std=c99 touch.c -o touch $(pkg-config --cflags --libs palpate) -lm
 *   LD_LIBRARY_PATH=PREFIX/lib ./touch DATASET.h5
 * or with the CMakeLists.txt beside this file:
 *   cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
 *
 * A fixed path replaces the device. A real loop differs in three places, marked DEVICE. */
#define _POSIX_C_SOURCE 200112L
#include <errno.h>
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ticks = 400, ticks_per_line = 40 };
static const double period = 1e-3; /* s */

static int fail(const char* what) {
  fprintf(stderr, "touch: %s: %s\n", what, palpate_last_error());
  return 1;
}

/* Sleeps until an absolute time, so that a late tick does not delay the next ones. */
static void sleepUntilNext(struct timespec* due) {
  due->tv_nsec += (long)(period * 1e9);
  if (due->tv_nsec >= 1000000000L) {
    due->tv_nsec -= 1000000000L;
    ++due->tv_sec;
  }
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, due, NULL) == EINTR) {
  }
}

/* Computes the mean outward unit normal of the triangles at a vertex. Returns 0 on failure. */
static int normalAt(const palpate_dataset* dataset, const palpate_dataset_info* info,
                    int32_t vertex, double normal[3]) {
  const size_t triangles = (size_t)info->triangle_count, vertices = (size_t)info->vertex_count;
  double* x = malloc(3 * vertices * sizeof *x);
  int32_t* corners = malloc(3 * triangles * sizeof *corners);
  int done = 0;
  normal[0] = normal[1] = normal[2] = 0;
  if (x != NULL && corners != NULL &&
      palpate_dataset_vertices(dataset, x, 3 * vertices) == PALPATE_OK &&
      palpate_dataset_triangles(dataset, corners, 3 * triangles) == PALPATE_OK) {
    for (size_t t = 0; t < triangles; ++t) {
      const int32_t* c = corners + 3 * t;
      if (c[0] != vertex && c[1] != vertex && c[2] != vertex) continue;
      double a[3], b[3];
      for (int i = 0; i < 3; ++i) {
        a[i] = x[3 * c[1] + i] - x[3 * c[0] + i];
        b[i] = x[3 * c[2] + i] - x[3 * c[0] + i];
      }
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] += a[j] * b[k] - a[k] * b[j];
      }
    }
    const double length =
        sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    done = length > 0;
    for (int i = 0; i < 3 && done; ++i) normal[i] /= length;
  }
  free(x);
  free(corners);
  return done;
}

/* Runs the loop: one reading, one contact update and one guarded force per tick. */
static int run(palpate_contact* contact, palpate_guard* guard, const palpate_space_info* space,
               const double normal[3], double depth) {
  struct timespec due;
  clock_gettime(CLOCK_MONOTONIC, &due);
  printf("#  time    gap or depth      force on the tool            |error| <  guards\n");
  printf("#  s       mm                N                            N\n");
  for (int tick = 0; tick < ticks; ++tick) {
    /* DEVICE: read the position here and map it to the frame of the scene. */
    const double phase = 2 * 3.14159265358979323846 * tick / ticks;
    const double inward = depth * 0.5 * (1 - cos(phase)) - 2e-4;
    double tool[3];
    for (int i = 0; i < 3; ++i) tool[i] = space->rest_position[i] - inward * normal[i];

    palpate_touch touch = PALPATE_INIT(palpate_touch);
    palpate_guarded_force force = PALPATE_INIT(palpate_guarded_force);
    if (palpate_contact_update(contact, tool, 1, &touch) != PALPATE_OK) return fail("contact");
    /* DEVICE: omit PALPATE_READING_FRESH if the position is not new; add PALPATE_READING_LOST if
     * the device is unplugged. */
    if (palpate_guard_limit(guard, tool, &touch, PALPATE_READING_FRESH, &force) != PALPATE_OK)
      return fail("guard"); /* the force is zero; a real loop sends it before it stops */
    /* DEVICE: send force.force here. */

    /* Printing is not real time; a real loop hands copies to another thread. */
    if (tick % ticks_per_line == 0)
      printf("%7.3f  %10.4f  %10.5f %10.5f %10.5f  %10.2g  %#5x%s\n", tick * period, 1e3 * inward,
             force.force[0], force.force[1], force.force[2], touch.error_bound,
             (unsigned)force.guards, touch.touching ? "  touching" : "");
    sleepUntilNext(&due);
  }
  return 0;
}

/* Prints one answer without contact, the same as that of `palpate query`. */
static int query(const palpate_dataset* dataset, const palpate_space_info* space,
                 const double normal[3], double depth) {
  double displacement[3];
  for (int i = 0; i < 3; ++i) displacement[i] = -depth * normal[i];
  palpate_sample sample = PALPATE_INIT(palpate_sample);
  if (palpate_query(dataset, 0, 0, displacement, &sample) != PALPATE_OK) return fail("query");
  printf("query %s %.17g %.17g %.17g force %.17g %.17g %.17g inside %d\n", space->name,
         displacement[0], displacement[1], displacement[2], sample.force[0], sample.force[1],
         sample.force[2], (int)sample.inside);
  return 0;
}

int main(int argc, char** argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: touch DATASET.h5 [DEPTH_MM]\n");
    return 2;
  }
  const double depth = 1e-3 * (argc > 2 ? atof(argv[2]) : 5);

  palpate_dataset* dataset = NULL;
  palpate_contact* contact = NULL;
  palpate_guard* guard = NULL;
  palpate_dataset_info info = PALPATE_INIT(palpate_dataset_info);
  palpate_space_info space = PALPATE_INIT(palpate_space_info);
  palpate_guard_options limits = PALPATE_INIT(palpate_guard_options);
  double normal[3];
  int code = 1;

  if (palpate_dataset_open(argv[1], NULL, &dataset) != PALPATE_OK ||
      palpate_dataset_describe(dataset, &info) != PALPATE_OK ||
      palpate_dataset_space(dataset, 0, &space) != PALPATE_OK ||
      palpate_contact_create(dataset, NULL, &contact) != PALPATE_OK ||
      palpate_guard_defaults("touch", period, &limits) != PALPATE_OK ||
      palpate_guard_create(&limits, &guard) != PALPATE_OK) {
    fail("cannot begin");
  } else if (!normalAt(dataset, &info, space.vertex, normal)) {
    fprintf(stderr, "touch: %s: the surface at \"%s\" has no normal\n", argv[1], space.name);
  } else {
    printf("# libpalpate %s, %s, \"%s\", %d vertices, %d spaces\n", palpate_version(), argv[1],
           info.name, (int)info.vertex_count, (int)info.space_count);
    code = query(dataset, &space, normal, depth);
    if (code == 0) code = run(contact, guard, &space, normal, depth);
  }
  palpate_guard_destroy(guard);
  palpate_contact_destroy(contact);
  palpate_dataset_close(dataset);
  return code;
}
