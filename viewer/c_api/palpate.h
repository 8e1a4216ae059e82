/* libpalpate: forces of a soft body from a Palpate dataset, for simulators with a loop of their
 * own.
 *
 * A dataset holds precomputed equilibria of a body for displacements of its active nodes. Each
 * active node has a *space*: a ball of displacements in which force, stiffness and shape are
 * interpolated. This library loads a dataset into memory and answers from it. docs/client.md tells
 * how to link, query and stay safe.
 *
 * Units and frame. SI throughout: m, N, N/m, J, s. Everything is in the frame of the scene, the
 * frame of the mesh; forces are those of the tissue on the tool. Matrices are row major:
 * stiffness[3 * i + j] = d force[i] / d position[j].
 *
 * Structures. Every one begins with `size`, and the caller sets it to sizeof(the structure) before
 * a call, for those that are filled too: PALPATE_INIT does. Later versions append members, and know
 * by `size` what a caller was compiled with. A program needs a library at least as new as the
 * header it was compiled with.
 *
 * Errors. What can fail returns a palpate_status; everything but PALPATE_OK has a text in
 * palpate_last_error. Unless a function says otherwise its results are left as they were then.
 * Nothing is thrown, and the process is never ended, on any input but an invalid pointer or a
 * handle that was given back.
 *
 * Threads. A dataset is immutable: any number of threads may use one at once. A contact and a guard
 * belong to one thread at a time. Handles of their own are independent of each other.
 *
 * Real time. Where it says so a function neither allocates nor locks nor waits nor does input and
 * output, when it returns PALPATE_OK, and its time is bounded. Everything else belongs into the
 * preparation.
 *
 * Lifetime. Handles are given back once, by the function that is named. A contact keeps its dataset
 * in memory: they may be given back in any order. Texts belong to the library or to the handle, as
 * said; never free them. */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

/* Initializer of a structure: its size, and zero in all other members. Nothing warns of it:
 *   palpate_touch touch = PALPATE_INIT(palpate_touch); */
#ifdef __cplusplus
#define PALPATE_INIT(type)              \
  [] {                                  \
    type palpate_zeroed = type();       \
    palpate_zeroed.size = sizeof(type); \
    return palpate_zeroed;              \
  }()
#else
#define PALPATE_INIT(type) \
  { .size = sizeof(type) }
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- version and errors ---- */

/* Of this header. Functions and members are only ever added while it stays the same; it is the
 * number in libpalpate.so.N. */
#define PALPATE_ABI_VERSION 0

/* Values are part of the ABI: only append. */
typedef enum palpate_status {
  PALPATE_OK = 0,
  /* NULL, wrong size, no such number or name, value out of range, small buffer */
  PALPATE_INVALID_ARGUMENT = 1,
  /* missing, unreadable, no dataset, damaged, or with nothing to touch */
  PALPATE_BAD_FILE = 2,
  PALPATE_OUT_OF_MEMORY = 3,
  PALPATE_FAILED = 4 /* anything else; worth a report */
} palpate_status;

/* Version of the library, as "0.1.0". Any thread, real time. */
PALPATE_API const char* palpate_version(void);

/* PALPATE_ABI_VERSION of the library: compare it with that of the header after loading the library
 * by hand. Any thread, real time. */
PALPATE_API int32_t palpate_abi_version(void);

/* The last failure of the calling thread: what happened, where, what to do; "" when there was none.
 * Calls that succeed leave it. Valid until the next failure on this thread. Real time. */
PALPATE_API const char* palpate_last_error(void);

/* ---- dataset ---- */

typedef struct palpate_dataset palpate_dataset;

typedef struct palpate_open_options {
  size_t size;
  /* Interpolation methods to prepare, by name, numbered in this order: "potential" (conservative,
   * the default), "trilinear", and those that `palpate query --help` lists. NULL with method_count
   * 0: these two. Each takes time and memory. */
  const char* const* methods;
  size_t method_count;
  /* m along the surface, >= 0: how far from an active node the surface can be touched. 0: as far as
   * the triangles at the active node reach. */
  double reach;
} palpate_open_options;

typedef struct palpate_dataset_info {
  size_t size;
  const char* name;       /* of the scene; owned by the dataset, as the next two */
  const char* file;       /* as it was given */
  const char* content_id; /* 64 hexadecimal digits; equal for equal results */
  int32_t contact_mode;   /* palpate_contact_mode that the scene asks for */
  int32_t space_count;
  int32_t method_count;
  int32_t vertex_count;   /* of the surface */
  int32_t triangle_count; /* of the surface */
  int32_t reserved;       /* 0 */
  double max_force;       /* N, of the scene: nothing was solved beyond it */
} palpate_dataset_info;

/* One active node and its configurations. */
typedef struct palpate_space_info {
  size_t size;
  const char* name;        /* of the active node in the scene; owned by the dataset */
  int32_t node;            /* number of the active node in the mesh */
  int32_t vertex;          /* number of the same in the surface (palpate_dataset_vertices) */
  double rest_position[3]; /* m, of the active node; of a finger where it is centred */
  double workspace_radius; /* m: displacements up to this long were solved */
  double spacing;          /* m, between solved displacements (before refinement) */
  double largest_force;    /* N, longest solved force */
} palpate_space_info;

/* Loads `file` (UTF-8), verifies it, and prepares everything: seconds, and memory of several times
 * the file. The file is closed then and may be replaced or removed. options: NULL for the defaults.
 * *dataset is to be given to palpate_dataset_close; NULL on failure. Errors: PALPATE_BAD_FILE,
 * PALPATE_INVALID_ARGUMENT (unknown method, negative reach), PALPATE_OUT_OF_MEMORY. Any thread; two
 * calls at once wait for each other. HDF5, which reads the file, is not thread-safe: no other part
 * of the process may be inside HDF5 meanwhile.
 */
PALPATE_API palpate_status palpate_dataset_open(const char* file,
                                                const palpate_open_options* options,
                                                palpate_dataset** dataset);

/* Gives the handle back; NULL is ignored. No other thread may be using it; contacts may. */
PALPATE_API void palpate_dataset_close(palpate_dataset* dataset);

/* Fills in *info. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_describe(const palpate_dataset* dataset,
                                                    palpate_dataset_info* info);

/* Spaces are numbered 0..space_count-1, in the order of the scene. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_space(const palpate_dataset* dataset, int32_t space,
                                                 palpate_space_info* info);
/* Number of the space of an active node. PALPATE_INVALID_ARGUMENT, listing the names there are,
 * when there is none. Any thread. */
PALPATE_API palpate_status palpate_dataset_find_space(const palpate_dataset* dataset,
                                                      const char* name, int32_t* space);

/* Name of a prepared method, 0..method_count-1; owned by the dataset; NULL, with an error text,
 * when there is none. Any thread, real time. */
PALPATE_API const char* palpate_dataset_method(const palpate_dataset* dataset, int32_t method);
/* Number of a prepared method. PALPATE_INVALID_ARGUMENT, listing those prepared, when it is none.
 * Any thread. */
PALPATE_API palpate_status palpate_dataset_find_method(const palpate_dataset* dataset,
                                                       const char* name, int32_t* method);

/* The surface at rest, copied into buffers of the caller. `capacity` counts numbers, not bytes;
 * more than needed is left as it was; less is PALPATE_INVALID_ARGUMENT and nothing is written. Any
 * thread, real time. */

/* vertices: 3 vertex_count numbers, x, y, z of every vertex, m. */
PALPATE_API palpate_status palpate_dataset_vertices(const palpate_dataset* dataset,
                                                    double* vertices, size_t capacity);
/* triangles: 3 triangle_count vertex numbers, counterclockwise seen from outside. */
PALPATE_API palpate_status palpate_dataset_triangles(const palpate_dataset* dataset,
                                                     int32_t* triangles, size_t capacity);
/* touchable: triangle_count numbers, 1 where a contact feels forces, else 0. */
PALPATE_API palpate_status palpate_dataset_touchable(const palpate_dataset* dataset,
                                                     uint8_t* touchable, size_t capacity);

/* ---- query ---- */

/* The answer to one displacement. Force and stiffness are always finite. */
typedef struct palpate_sample {
  size_t size;
  double force[3];     /* N */
  double stiffness[9]; /* N/m, row major: the exact derivative of this method's force */
  double energy;       /* J, stored in the tissue; NaN when the method has none */
  /* N, on the error of the force, estimated to hold at 99 % of places; NaN: not known */
  double error_bound;
  double coverage;  /* 0..1, share of the answer that stands on solved equilibria of one branch */
  int32_t inside;   /* 1: in what was computed. 0: a continuation that only stiffens */
  int32_t reserved; /* 0 */
} palpate_sample;

/* Force and stiffness of one space. displacement: of its active node from its rest position, m.
 * Beyond what was computed the force goes on from the edge, of the same energy, and only stiffens;
 * the error bound grows with it, and inside = 0. A displacement that is not finite gives no force
 * and inside = 0; that is no error, so that a bad reading does not stop a loop. Any thread, real
 * time (wait-free). */
PALPATE_API palpate_status palpate_query(const palpate_dataset* dataset, int32_t space,
                                         int32_t method, const double displacement[3],
                                         palpate_sample* sample);

/* The deformed surface for a displacement of one active node alone: displacements of the vertices,
 * m, 3 vertex_count floats; `capacity` as with palpate_dataset_vertices. *inside (may be NULL): as
 * in palpate_sample. A displacement that is not finite gives the shape at rest. Any thread, real
 * time; its time grows with the surface, so it belongs to the thread that draws. */
PALPATE_API palpate_status palpate_displacements(const palpate_dataset* dataset, int32_t space,
                                                 const double displacement[3], float* displacements,
                                                 size_t capacity, int32_t* inside);

/* ---- areas ---- */

/* A surface that a finger of finite size touches: one energy E(s, p) of the finger's place s and
 * its displacement p, which answers anywhere between the sites that were solved. Contacts use it
 * by themselves; with this family a simulator asks it directly. Areas are numbered 0 upwards, in
 * the order of the scene. Their sites are spaces too, each alone. */

typedef struct palpate_area_info {
  size_t size;
  const char* name;        /* in the scene; owned by the dataset */
  double finger_radius;    /* m */
  double workspace_radius; /* m: displacements up to this long were solved */
  int32_t site_count;
  int32_t reserved; /* 0 */
} palpate_area_info;

/* The answer to one place and displacement. Force, stiffness and drive are always finite. */
typedef struct palpate_area_sample {
  size_t size;
  double force[3];     /* N, on the tool: -dE/dp */
  double stiffness[9]; /* N/m, row major: the exact derivative of force by p */
  double drive[3];     /* N, -dE/ds along the surface: where the tissue slides the finger to */
  double at[3];        /* m, the place of the surface at rest nearest to the one that was asked */
  double energy;       /* J, stored in the tissue */
  double error_bound;  /* as in palpate_sample, and the next one */
  double coverage;
  /* 1: at a place of the area that can be touched, in what was computed there. 0: an answer for
   * `at` all the same, which lies elsewhere (distance), has no site near, or rests on what is
   * fixed; or a continuation as in palpate_sample */
  int32_t inside;
  int32_t triangle; /* of the surface, that `at` lies in; -1 for what is not finite, `at` is 0 */
  /* m, from the place that was asked to `at`: beyond a quarter of the finger's radius (a millionth
   * of the body's size if that is more) never inside; NaN for what is not finite */
  double distance;
} palpate_area_sample;

/* How many areas there are; 0 where a scene has no finger. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_area_count(const palpate_dataset* dataset,
                                                      int32_t* count);
/* Fills in *info. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_area(const palpate_dataset* dataset, int32_t area,
                                                palpate_area_info* info);
/* Number of an area. PALPATE_INVALID_ARGUMENT, listing the names there are, when there is none. Any
 * thread. */
PALPATE_API palpate_status palpate_dataset_find_area(const palpate_dataset* dataset,
                                                     const char* name, int32_t* area);

/* Force and drive of the finger of an area. at: m, on or near the surface at rest; the answer is
 * that of the nearest point of it, and not inside for a place that is not near. displacement: of
 * the finger from there, m; beyond what was computed as in palpate_query. A place or
 * displacement that is not finite gives no force and inside = 0. Any thread, real time (wait-free);
 * beside what is fixed it takes some 100 microseconds longer, and about a millisecond where half of
 * the finger rests on it. */
PALPATE_API palpate_status palpate_area_query(const palpate_dataset* dataset, int32_t area,
                                              const double at[3], const double displacement[3],
                                              palpate_area_sample* sample);

/* ---- many answers at once ---- */

/* For callers to whom a call is expensive (Python, MATLAB, another process): arrays of theirs, for
 * count questions one after the other; NULL for what is not wanted. Numbers are those of
 * palpate_sample and palpate_area_sample, and the same to the last bit. */
typedef struct palpate_answers {
  size_t size;
  double* forces;       /* 3 count, N */
  double* stiffnesses;  /* 9 count, N/m, row major */
  double* energies;     /* count, J */
  double* error_bounds; /* count, N */
  double* coverages;    /* count */
  uint8_t* inside;      /* count, 1 or 0 */
  /* Of areas; NULL for a space. */
  double* drives;     /* 3 count, N */
  double* places;     /* 3 count, m: `at` of palpate_area_sample */
  int32_t* triangles; /* count */
  double* distances;  /* count, m */
} palpate_answers;

/* palpate_query for `count` displacements (3 count numbers, m). Any thread, real time; its time
 * grows with count. */
PALPATE_API palpate_status palpate_query_many(const palpate_dataset* dataset, int32_t space,
                                              int32_t method, const double* displacements,
                                              size_t count, const palpate_answers* answers);

/* palpate_area_query for `count` places and displacements (3 count numbers each, m); `places` may
 * be answers->places. Any thread, real time; its time grows with count. */
PALPATE_API palpate_status palpate_area_query_many(const palpate_dataset* dataset, int32_t area,
                                                   const double* places,
                                                   const double* displacements, size_t count,
                                                   const palpate_answers* answers);

/* ---- contact ---- */

/* A point tool on the body: finds where it touches, blends spaces there, slides with friction. */
typedef struct palpate_contact palpate_contact;

/* Values are part of the ABI: only append. */
typedef enum palpate_contact_mode {
  PALPATE_UNILATERAL = 0, /* the tissue pushes the tool away and never pulls */
  PALPATE_GLUED = 1       /* the tool takes hold of the surface, and can pull it too */
} palpate_contact_mode;

typedef struct palpate_contact_options {
  size_t size;
  int32_t mode;    /* palpate_contact_mode; default: what the scene asks for */
  int32_t method;  /* number of a prepared method; default 0 */
  double friction; /* Coulomb's coefficient, >= 0; unilateral only; default 0.2 */
  /* m, >= 0; glued: the tool takes hold of a surface this near; default 0.005 */
  double grab_distance;
  /* m per update, > 0, that the point of contact may slide at most; default 0.002 */
  double most_slide;
  /* 0..1 of the force per update, > 0: what sliding may change it by beyond what the tool's motion
   * does, where the point of contact runs down from a ridge. Smaller is softer, and lags behind;
   * default 0.005. */
  double most_relaxation;
} palpate_contact_options;

#define PALPATE_MOST_SHARES 9

/* What the tissue does to the tool. The force is not limited yet: give it to a guard. */
typedef struct palpate_touch {
  size_t size;
  int32_t touching; /* 1 or 0 */
  /* 1: the force may differ from the last one by more than motion explains (contact began away from
   * the surface, ended with a force, or the dataset was switched). The guard fades such steps in.
   */
  int32_t stepped;
  int32_t inside;         /* as in palpate_sample, of all spaces that take part */
  int32_t triangle;       /* in contact; -1: none */
  double force[3];        /* N, on the tool; zero when not touching */
  double stiffness[9];    /* N/m, row major, d force / d tool with the point of contact held */
  double energy;          /* J, stored in the tissue; NaN when the method has none */
  double error_bound;     /* N; NaN: not known */
  double coverage;        /* 0..1 */
  double barycentric[3];  /* of the point of contact in the triangle */
  double anchor[3];       /* m, the point of contact at rest */
  double normal[3];       /* unit, outward, of the surface at rest there */
  double displacement[3]; /* m, of the point of contact: tool - anchor */
  double gap;             /* m, when not touching: distance to the body, negative inside of it */
  int32_t share_count;    /* spaces that take part, at most PALPATE_MOST_SHARES */
  int32_t share_spaces[PALPATE_MOST_SHARES];
  double share_weights[PALPATE_MOST_SHARES]; /* sum 1 */
  /* m, along the displacement, beyond what was computed, where the force is that of a continuation
   * that only stiffens; 0: inside. Draw the tool at tool - displacement * beyond / |displacement|.
   */
  double beyond;
} palpate_touch;

/* Fills in the defaults above for a dataset (options->size is set by the caller). Any thread, real
 * time. */
PALPATE_API palpate_status palpate_contact_defaults(const palpate_dataset* dataset,
                                                    palpate_contact_options* options);

/* options: NULL for the defaults. *contact is to be given to palpate_contact_destroy; NULL on
 * failure. */
PALPATE_API palpate_status palpate_contact_create(const palpate_dataset* dataset,
                                                  const palpate_contact_options* options,
                                                  palpate_contact** contact);

/* Gives the handle back; NULL is ignored. */
PALPATE_API void palpate_contact_destroy(palpate_contact* contact);

/* One tick: the tool is at `tool`, m. Call it at the rate of the loop, with every reading in turn:
 * contact depends on the way that the tool took. The tool touches when it crosses a touchable
 * triangle from outside, so the first position should be outside of the body. hold: glued mode
 * only, 0 lets go. A position that is not finite ends the contact. Real time. */
PALPATE_API palpate_status palpate_contact_update(palpate_contact* contact, const double tool[3],
                                                  int32_t hold, palpate_touch* touch);

/* Ends the contact; the tool must come from outside again. Real time. */
PALPATE_API palpate_status palpate_contact_release(palpate_contact* contact);

/* Goes on with another dataset or another prepared method, to feel the difference. Contact is kept
 * where both surfaces have the same triangles. Real time when the dataset used so far is still open
 * (else this frees it). */
PALPATE_API palpate_status palpate_contact_use(palpate_contact* contact,
                                               const palpate_dataset* dataset, int32_t method);

/* The deformed surface of a contact, from the touch that palpate_contact_update gave, so that a
 * touch may be copied to the thread that draws. The dataset must be the contact's. Displacements of
 * the vertices, m, 3 vertex_count floats; `capacity` as with palpate_dataset_vertices. They blend
 * the shapes of the spaces that take part, and let the surface pass through the tool. Without
 * contact all zero. Of the touch touching, displacement, triangle, barycentric, anchor and the
 * shares are read. Any thread; allocates, so it belongs to the thread that draws. */
PALPATE_API palpate_status palpate_touch_displacements(const palpate_dataset* dataset,
                                                       const palpate_touch* touch,
                                                       float* displacements, size_t capacity);

/* ---- devices and the guard ---- */

/* What a haptic device can do. */
typedef struct palpate_profile {
  size_t size;
  const char* name;        /* owned by the library */
  double max_force;        /* N */
  double max_stiffness;    /* N/m, of what the closed loop renders stably */
  double workspace_radius; /* m */
} palpate_profile;

/* By name: "touch", "omni", "falcon", "omega", ... PALPATE_INVALID_ARGUMENT, listing all, for
 * another. Any thread. */
PALPATE_API palpate_status palpate_device_profile(const char* name, palpate_profile* device);

/* Stands between the force of a contact and a device: limits length and rate of the force, fades
 * steps in, keeps the loop passive, and gives zero when anything is wrong. There is no way to
 * switch a limit off. */
typedef struct palpate_guard palpate_guard;

typedef struct palpate_guard_options {
  size_t size;
  double period;    /* s, > 0, of the loop; default 0.001 */
  double max_force; /* N, > 0; default 3.3, of the smallest device */
  double max_slew;  /* N/s; 0 or NaN, the default: max_force in 10 ms */
  double ramp;      /* s, > 0, in which a step of the force is faded in; default 0.05 */
  /* s, > 0, without a fresh reading, after which the force goes to zero; default 0.02 */
  double stall;
  double max_stiffness; /* N/m, > 0, of the device; default 400; limits nothing any more */
  double energy_credit; /* J, >= 0, of dissipated energy that is remembered at most; default 1e-4 */
  /* s, >= 0, from when a position was read to when the force that answers it acts, at most 30
   * periods; default 0: the force is sent in the call's own period, and acts at once */
  double delay;
} palpate_guard_options;

/* Of the reading, the flags of palpate_guard_limit. */
#define PALPATE_READING_FRESH 1u /* the position is new; never setting it means zero force */
#define PALPATE_READING_LOST 2u  /* the device is gone: zero at once */
#define PALPATE_LOOP_LATE 4u     /* the loop hung before this tick: zero at once, then faded in */

/* Why a force is not the raw one: bits of palpate_guarded_force.guards. Only append. */
#define PALPATE_GUARD_RAMPED 1u      /* a step, or a jump of the tool, is being faded in */
#define PALPATE_GUARD_DAMPED 2u      /* the hand would get back more energy than it put in */
#define PALPATE_GUARD_CLAMPED 4u     /* longer than max_force */
#define PALPATE_GUARD_SLEWED 8u      /* changing faster than max_slew */
#define PALPATE_GUARD_STALLED 16u    /* no fresh reading for `stall` seconds */
#define PALPATE_GUARD_LOST 32u       /* the device is gone */
#define PALPATE_GUARD_NOT_FINITE 64u /* the position or the raw force was not finite */
#define PALPATE_GUARD_LATE 128u      /* the loop hung */
#define PALPATE_GUARD_BEYOND 256u    /* deeper than was computed: the force of a wall */

typedef struct palpate_guarded_force {
  size_t size;
  double force[3]; /* N, finite, |force| <= max_force: what to send to the device */
  /* J, put in by the hand less stored in the tissue; negative: the loop created energy */
  double passivity;
  uint32_t guards;   /* PALPATE_GUARD_... bits */
  uint32_t reserved; /* 0 */
} palpate_guarded_force;

/* Options for a device by name at a period (s, > 0); device NULL: the defaults above. options->size
 * is set by the caller. Any thread. */
PALPATE_API palpate_status palpate_guard_defaults(const char* device, double period,
                                                  palpate_guard_options* options);

/* options: NULL for the defaults. *guard is to be given to palpate_guard_destroy; NULL on failure.
 */
PALPATE_API palpate_status palpate_guard_create(const palpate_guard_options* options,
                                                palpate_guard** guard);

/* Gives the handle back; NULL is ignored. */
PALPATE_API void palpate_guard_destroy(palpate_guard* guard);

/* One tick: the force to send. tool: m, the position that the touch was computed from. touch: of a
 * contact; or filled in by a simulator with forces of its own (size, touching, stepped, force,
 * stiffness, energy are read). flags: PALPATE_READING_FRESH, PALPATE_READING_LOST,
 * PALPATE_LOOP_LATE, or'ed; other bits are an error. Call it exactly once per period, also while
 * nothing is touched: it counts time in calls. Whenever the status is not PALPATE_OK, and `guarded`
 * can be written, its force is zero: send that; the next force is faded in from there. Real time.
 */
PALPATE_API palpate_status palpate_guard_limit(palpate_guard* guard, const double tool[3],
                                               const palpate_touch* touch, uint32_t flags,
                                               palpate_guarded_force* guarded);

/* Forgets the past: as new. Real time. */
PALPATE_API palpate_status palpate_guard_reset(palpate_guard* guard);

#ifdef __cplusplus
}
#endif

#endif /* PALPATE_H */
