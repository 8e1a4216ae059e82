/* libpalpate: forces of a soft body from a Palpate dataset, for simulators that run their own loop.
 *
 * A dataset holds precomputed equilibria of a body for displacements of its active nodes. Each
 * active node has a *space*: a ball of displacements in which force, stiffness and shape are
 * interpolated. This library loads a dataset into memory and interpolates in it. docs/client.md
 * describes linking, querying and safety.
 *
 * Units and frame. SI throughout: m, N, N/m, J, s. All vectors are in the frame of the scene, which
 * is the frame of the mesh. Forces are those of the tissue on the tool. Matrices are row major:
 * stiffness[3 * i + j] = d force[i] / d position[j].
 *
 * Structures. Every structure begins with `size`. The caller sets it to sizeof(the structure)
 * before each call, also for structures that the library fills; PALPATE_INIT does this. Later
 * versions append members, and `size` tells the library which members the caller was compiled with.
 * A program needs a library at least as new as the header it was compiled with.
 *
 * Errors. Functions that can fail return a palpate_status. After any status but PALPATE_OK,
 * palpate_last_error returns a text, and the outputs are unchanged unless the function says
 * otherwise. No function throws or ends the process, whatever its input, except for invalid
 * pointers and handles that were already closed or destroyed.
 *
 * Threads. A dataset is immutable: any number of threads may use it at the same time. A contact or
 * a guard may be used by one thread at a time. Different handles are independent of each other.
 *
 * Real time. A function marked "real time" does not allocate, lock, wait, or do input and output
 * when it returns PALPATE_OK, and its time is bounded. Do not call any other function from the
 * loop.
 *
 * Lifetime. Each handle is closed or destroyed once, by the function named at its creation. A
 * contact keeps its dataset in memory, so the two may be closed in any order. Texts belong to the
 * library or to a handle, as stated for each text; never free them. */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

/* Initializer of a structure: sets `size` and zeroes all other members, without compiler warnings:
 *
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

/* ABI version of this header, the N in libpalpate.so.N. While it stays the same, functions and
 * members are only added. */
#define PALPATE_ABI_VERSION 0

/* Values are part of the ABI: only append. */
typedef enum palpate_status {
  PALPATE_OK = 0,
  /* an argument is NULL or out of range, a name or number is unknown, a structure has a wrong size,
   * or a buffer is too small */
  PALPATE_INVALID_ARGUMENT = 1,
  /* the file is missing, unreadable, damaged, not a dataset, or has no touchable surface */
  PALPATE_BAD_FILE = 2,
  PALPATE_OUT_OF_MEMORY = 3,
  PALPATE_FAILED = 4 /* any other failure; please report it */
} palpate_status;

/* Returns the version of the library, such as "0.1.0". Any thread, real time. */
PALPATE_API const char* palpate_version(void);

/* Returns PALPATE_ABI_VERSION of the library. After loading the library by hand, compare it with
 * the header's. Any thread, real time. */
PALPATE_API int32_t palpate_abi_version(void);

/* Returns the text of the last failure of the calling thread: what failed, where, and what to do.
 * "" before the first failure; a successful call does not clear it. Valid until the next failure on
 * this thread. Real time. */
PALPATE_API const char* palpate_last_error(void);

/* ---- dataset ---- */

typedef struct palpate_dataset palpate_dataset;

typedef struct palpate_open_options {
  size_t size;
  /* Names of the interpolation methods to prepare. Other functions take a method by its index in
   * this array. NULL with method_count 0 prepares "potential" (index 0), which is conservative, and
   * "trilinear" (index 1), for comparison. `palpate query --help` lists all methods. Each method
   * takes time and memory. */
  const char* const* methods;
  size_t method_count;
  /* Distance from an active node, along the surface, up to which the surface can be touched, m,
   * >= 0. With 0, the touchable part ends with the triangles around the active node. */
  double reach;
} palpate_open_options;

typedef struct palpate_dataset_info {
  size_t size;
  const char* name;       /* name of the scene; this text and the next two belong to the dataset */
  const char* file;       /* path as given to palpate_dataset_open */
  const char* content_id; /* hash of the results, 64 hexadecimal digits */
  int32_t contact_mode;   /* palpate_contact_mode chosen by the scene */
  int32_t space_count;
  int32_t method_count;
  int32_t vertex_count;   /* number of vertices of the surface */
  int32_t triangle_count; /* number of triangles of the surface */
  int32_t reserved;       /* 0 */
  double max_force;       /* N, force limit of the scene, beyond which solving stops */
} palpate_dataset_info;

/* An active node and its space. */
typedef struct palpate_space_info {
  size_t size;
  const char* name; /* name of the active node in the scene; owned by the dataset */
  int32_t node;     /* index of the active node in the mesh */
  /* index of the active node in palpate_dataset_vertices; -1 if the node lies inside the body */
  int32_t vertex;
  double rest_position[3]; /* m, of the active node; for a finger, its centre */
  double workspace_radius; /* m; displacements up to this length were solved */
  double spacing;          /* m, distance of neighbouring solved displacements before refinement */
  double largest_force;    /* N, magnitude of the largest solved force */
} palpate_space_info;

/* Loads `file` (UTF-8), verifies it, and prepares the interpolation. Takes seconds, and several
 * times as much memory as the file's size. The file is closed on return and may then be replaced or
 * removed. options: NULL for the defaults. Pass *dataset to palpate_dataset_close later; it is NULL
 * on failure. Errors: PALPATE_BAD_FILE, PALPATE_INVALID_ARGUMENT (unknown method, negative reach),
 * PALPATE_OUT_OF_MEMORY. Any thread; concurrent calls wait for each other. HDF5, which reads the
 * file, is not thread-safe: no other part of the process may use HDF5 during the call. */
PALPATE_API palpate_status palpate_dataset_open(const char* file,
                                                const palpate_open_options* options,
                                                palpate_dataset** dataset);

/* Closes the dataset; NULL is ignored. No other thread may be using the handle. Contacts that use
 * the dataset stay valid, and other threads may be using them. */
PALPATE_API void palpate_dataset_close(palpate_dataset* dataset);

/* Describes the dataset in *info. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_describe(const palpate_dataset* dataset,
                                                    palpate_dataset_info* info);

/* Describes a space in *info. Spaces are numbered 0..space_count-1, in the order of the scene. Any
 * thread, real time. */
PALPATE_API palpate_status palpate_dataset_space(const palpate_dataset* dataset, int32_t space,
                                                 palpate_space_info* info);
/* Finds the number of an active node's space by the node's name. An unknown name is
 * PALPATE_INVALID_ARGUMENT, and the error text lists the known names. Any thread. */
PALPATE_API palpate_status palpate_dataset_find_space(const palpate_dataset* dataset,
                                                      const char* name, int32_t* space);

/* Returns the name of a prepared method by its number, 0..method_count-1; owned by the dataset.
 * Returns NULL, with an error text, for any other number. Any thread, real time. */
PALPATE_API const char* palpate_dataset_method(const palpate_dataset* dataset, int32_t method);
/* Finds the number of a prepared method by its name. An unknown name is PALPATE_INVALID_ARGUMENT,
 * and the error text lists the prepared methods. Any thread. */
PALPATE_API palpate_status palpate_dataset_find_method(const palpate_dataset* dataset,
                                                       const char* name, int32_t* method);

/* The surface at rest, copied into buffers of the caller. `capacity` counts elements, not bytes. If
 * the buffer is larger than needed, its other elements stay unchanged. If it is too small, nothing
 * is written and the status is PALPATE_INVALID_ARGUMENT. Any thread, real time. */

/* vertices: x, y, z of each vertex, m; 3 * vertex_count numbers. */
PALPATE_API palpate_status palpate_dataset_vertices(const palpate_dataset* dataset,
                                                    double* vertices, size_t capacity);
/* triangles: 3 * triangle_count vertex indices, counterclockwise seen from outside. */
PALPATE_API palpate_status palpate_dataset_triangles(const palpate_dataset* dataset,
                                                     int32_t* triangles, size_t capacity);
/* touchable: one number per triangle: 1 if a contact can feel forces there, else 0. */
PALPATE_API palpate_status palpate_dataset_touchable(const palpate_dataset* dataset,
                                                     uint8_t* touchable, size_t capacity);

/* ---- query ---- */

/* Result of a query at one displacement. Force and stiffness are always finite. */
typedef struct palpate_sample {
  size_t size;
  double force[3];     /* N */
  double stiffness[9]; /* N/m, row major: the derivative of force, exact in the solved region */
  double energy;       /* J, stored in the tissue; NaN if the method has none */
  /* N, bound on the error of the force, estimated to hold at 99 % of places; NaN: unknown */
  double error_bound;
  /* 0..1. 1: interpolated only from solved equilibria of one branch; 0: extrapolated */
  double coverage;
  /* 1: the displacement is in the solved region. 0: the sample is an extrapolation. Beyond the
   * solved region, the force is that of a wall that only gets stiffer, and coverage is that at the
   * edge of the region */
  int32_t inside;
  int32_t reserved; /* 0 */
} palpate_sample;

/* Interpolates force and stiffness in one space. displacement: of the space's active node from its
 * rest position, m. Beyond the solved region, inside is 0. The force then continues from the edge
 * of the region as the negative gradient of the same energy and only gets stiffer, and the error
 * bound grows with the added force. A NaN in `displacement` gives zero force and inside = 0; an
 * infinite displacement is treated as a very long one. Neither is an error, so that a bad reading
 * does not stop a loop. Any thread, real time (wait-free). */
PALPATE_API palpate_status palpate_query(const palpate_dataset* dataset, int32_t space,
                                         int32_t method, const double displacement[3],
                                         palpate_sample* sample);

/* Computes the deformed surface for a displacement of a single active node. displacements: output,
 * displacement of each vertex, m, 3 * vertex_count floats; `capacity` as in
 * palpate_dataset_vertices. *inside (may be NULL): 1 if the displacement is at most
 * workspace_radius long and one of the lattice points around it was solved, else 0. A NaN in
 * displacement gives the shape at rest. Any thread, real time; the time grows with the surface, so
 * call it on the drawing thread. */
PALPATE_API palpate_status palpate_displacements(const palpate_dataset* dataset, int32_t space,
                                                 const double displacement[3], float* displacements,
                                                 size_t capacity, int32_t* inside);

/* ---- areas ---- */

/* An area is a part of the surface that a finger of finite size touches. Equilibria were solved
 * with the finger at a number of places, the *sites*. One energy E(s, p), a function of the
 * finger's place s and displacement p, gives the force at and between the sites. Contacts use it
 * automatically; these functions query it directly. Areas are numbered from 0, in the order of the
 * scene. Each site of an area is also a space. */

typedef struct palpate_area_info {
  size_t size;
  const char* name;        /* name in the scene; owned by the dataset */
  double finger_radius;    /* m */
  double workspace_radius; /* m; displacements up to this length were solved */
  int32_t site_count;
  int32_t reserved; /* 0 */
} palpate_area_info;

/* Result of a query at one place and displacement. Force, stiffness and drive are always finite. */
typedef struct palpate_area_sample {
  size_t size;
  double force[3];     /* N, on the tool: -dE/dp */
  double stiffness[9]; /* N/m, row major: d force / d p, exact in the solved region */
  /* N, part of -dE/ds along the surface. The tissue slides the finger in this direction */
  double drive[3];
  double at[3];       /* m, the point of the surface at rest nearest to the queried place */
  double energy;      /* J, stored in the tissue */
  double error_bound; /* as in palpate_sample */
  double coverage;    /* as in palpate_sample */
  /* 1: `at` is a touchable place of the area, near the queried one, and p is within the region
   * solved there. 0: the sample is computed for `at` all the same, but is not reliable. The reason
   * is one of these: the queried place is too far from `at` (see distance), no site is near, the
   * finger rests on fixed nodes, or the force is a continuation as in palpate_sample */
  int32_t inside;
  /* surface triangle that contains `at`; -1, with `at` zero, if the input was not finite */
  int32_t triangle;
  /* m, from the queried place to `at`. inside is 0 if this is more than a quarter of the finger's
   * radius (or a millionth of the body's size, if that is larger). NaN if the input was not
   * finite */
  double distance;
} palpate_area_sample;

/* Gives the number of areas; 0 for a scene without a finger. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_area_count(const palpate_dataset* dataset,
                                                      int32_t* count);
/* Describes an area in *info. Any thread, real time. */
PALPATE_API palpate_status palpate_dataset_area(const palpate_dataset* dataset, int32_t area,
                                                palpate_area_info* info);
/* Finds the number of an area by its name. An unknown name is PALPATE_INVALID_ARGUMENT, and the
 * error text lists the known names. Any thread. */
PALPATE_API palpate_status palpate_dataset_find_area(const palpate_dataset* dataset,
                                                     const char* name, int32_t* area);

/* Interpolates force and drive of an area's finger. at: m, on or near the surface at rest. The
 * sample is computed for the point of the surface nearest to `at`; inside = 0 if that point is too
 * far away. displacement: of the finger from that point, m. Beyond the solved region the force
 * continues as in palpate_query. A place or displacement that is not finite gives zero force and
 * inside = 0. Any thread, real time (wait-free). Near fixed nodes the call takes about 100
 * microseconds longer, and about a millisecond longer if half of the finger is on fixed nodes. */
PALPATE_API palpate_status palpate_area_query(const palpate_dataset* dataset, int32_t area,
                                              const double at[3], const double displacement[3],
                                              palpate_area_sample* sample);

/* ---- many answers at once ---- */

/* Output arrays for `count` queries in one call, for callers for whom each call is expensive
 * (Python, MATLAB, another process). The arrays belong to the caller; pass NULL for unwanted ones.
 * The values are exactly those of palpate_sample and palpate_area_sample. */
typedef struct palpate_answers {
  size_t size;
  double* forces;       /* 3 * count, N */
  double* stiffnesses;  /* 9 * count, N/m, row major */
  double* energies;     /* count, J */
  double* error_bounds; /* count, N */
  double* coverages;    /* count */
  uint8_t* inside;      /* count, 1 or 0 */
  /* Only for areas; must be NULL for a space. */
  double* drives;     /* 3 * count, N */
  double* places;     /* 3 * count, m: `at` of palpate_area_sample */
  int32_t* triangles; /* count */
  double* distances;  /* count, m */
} palpate_answers;

/* Queries a space at `count` displacements (3 * count numbers, m), as palpate_query does. Any
 * thread, real time; the time grows with count. */
PALPATE_API palpate_status palpate_query_many(const palpate_dataset* dataset, int32_t space,
                                              int32_t method, const double* displacements,
                                              size_t count, const palpate_answers* answers);

/* Queries an area at `count` places and displacements (3 * count numbers each, m), as
 * palpate_area_query does. `places` may be answers->places. Any thread, real time; the time grows
 * with count. */
PALPATE_API palpate_status palpate_area_query_many(const palpate_dataset* dataset, int32_t area,
                                                   const double* places,
                                                   const double* displacements, size_t count,
                                                   const palpate_answers* answers);

/* ---- contact ---- */

/* Contact of a point tool with the body. A contact finds the point of contact, blends the forces of
 * the spaces around that point, and lets it slide with friction. */
typedef struct palpate_contact palpate_contact;
/* A live solver, see below. */
typedef struct palpate_live palpate_live;

/* Values are part of the ABI: only append. */
typedef enum palpate_contact_mode {
  PALPATE_UNILATERAL = 0, /* the tissue pushes the tool away and never pulls */
  PALPATE_GLUED = 1       /* the tool grips the surface, and can pull it too */
} palpate_contact_mode;

typedef struct palpate_contact_options {
  size_t size;
  int32_t mode;    /* palpate_contact_mode; default: that of the scene */
  int32_t method;  /* index of a prepared method; default 0 */
  double friction; /* Coulomb's coefficient, >= 0; unilateral only; default 0.2 */
  /* m, >= 0; glued: the tool grips the surface within this distance; default 0.005 */
  double grab_distance;
  /* m, > 0: largest slide of the point of contact per update; default 0.002 */
  double most_slide;
  /* > 0: largest relative change of the force per update by sliding, in addition to the change by
   * the tool's own motion; default 0.005. This limit keeps the force continuous while the point of
   * contact slides down from a ridge. A smaller value feels softer and lags more. */
  double most_relaxation;
  /* live solver of the same dataset, which corrects the forces of this contact; default NULL */
  palpate_live* live;
} palpate_contact_options;

#define PALPATE_MOST_SHARES 9

/* State of a contact after an update. The force is not limited yet: pass it through a guard. */
typedef struct palpate_touch {
  size_t size;
  int32_t touching; /* 1 or 0 */
  /* 1: the force may have changed by more than the tool's motion explains, because contact ended
   * while there was a force, or the dataset or method was switched during contact. The guard fades
   * such steps in. */
  int32_t stepped;
  /* 1 only if palpate_sample.inside is 1 in every blended space; 0 also if the position of the tool
   * was not finite */
  int32_t inside;
  int32_t triangle;       /* surface triangle in contact; -1: none */
  double force[3];        /* N, on the tool; zero when not touching */
  double stiffness[9];    /* N/m, row major, d force / d tool at a fixed point of contact */
  double energy;          /* J, stored in the tissue; NaN if the method has none */
  double error_bound;     /* N; NaN: unknown */
  double coverage;        /* 0..1 */
  double barycentric[3];  /* coordinates of the point of contact in the triangle */
  double anchor[3];       /* m, the point of contact at rest */
  double normal[3];       /* unit outward normal of the surface at rest there */
  double displacement[3]; /* m, of the point of contact: tool - anchor */
  double gap;             /* m, distance to the body when not touching; negative inside the body */
  int32_t share_count;    /* number of blended spaces, at most PALPATE_MOST_SHARES */
  int32_t share_spaces[PALPATE_MOST_SHARES];
  double share_weights[PALPATE_MOST_SHARES]; /* sum 1 */
  /* m, length of the part of the displacement that lies beyond the solved region; 0 within the
   * region. The force of that part is a continuation that only gets stiffer. Draw the tool at
   *   tool - displacement * beyond / |displacement| */
  double beyond;
  double drive[3]; /* as in palpate_area_sample; zero outside of areas */
} palpate_touch;

/* Fills in the default options for a dataset. The caller sets options->size. Any thread, real
 * time. */
PALPATE_API palpate_status palpate_contact_defaults(const palpate_dataset* dataset,
                                                    palpate_contact_options* options);

/* Creates a contact. options: NULL for the defaults. options->live: of the same dataset, and used
 * by no other contact. Pass *contact to palpate_contact_destroy later; it is NULL on failure. */
PALPATE_API palpate_status palpate_contact_create(const palpate_dataset* dataset,
                                                  const palpate_contact_options* options,
                                                  palpate_contact** contact);

/* Destroys the contact; NULL is ignored. */
PALPATE_API void palpate_contact_destroy(palpate_contact* contact);

/* Runs one tick with the tool at `tool`, m. Call it at the rate of the loop, for every reading in
 * order: contact depends on the path of the tool. The tool touches when it crosses a touchable
 * triangle from outside, so the first position should be outside the body. hold: glued mode only; 0
 * lets go. A position that is not finite ends the contact. Real time. */
PALPATE_API palpate_status palpate_contact_update(palpate_contact* contact, const double tool[3],
                                                  int32_t hold, palpate_touch* touch);

/* Ends the contact. The tool can touch again after it was outside (unilateral), or after an update
 * with hold = 0 or with the tool farther away than grab_distance (glued). Real time. */
PALPATE_API palpate_status palpate_contact_release(palpate_contact* contact);

/* Switches to another dataset or prepared method, to compare how they feel. The tool stays in
 * contact if both surfaces have the same vertices and triangles and the point of contact is
 * touchable in the new dataset. Real time while the previous dataset is still open (otherwise this
 * call frees the previous dataset). */
PALPATE_API palpate_status palpate_contact_use(palpate_contact* contact,
                                               const palpate_dataset* dataset, int32_t method);

/* Computes the deformed surface of a contact. touch: from palpate_contact_update; a copy may be
 * passed to the drawing thread. dataset: that of the contact. displacements: output, displacement
 * of each vertex, m, 3 * vertex_count floats, all zero without contact; `capacity` as in
 * palpate_dataset_vertices. The surface is a blend of the shapes of the touch's spaces, and passes
 * through the tool. Reads only touching, displacement, beyond, triangle, barycentric, anchor and
 * the shares of the touch. Any thread; allocates, so call it on the drawing thread. */
PALPATE_API palpate_status palpate_touch_displacements(const palpate_dataset* dataset,
                                                       const palpate_touch* touch,
                                                       float* displacements, size_t capacity);

/* ---- many contacts at once ---- */

/* Contacts that are independent of each other, for simulators that run many environments. Each has
 * a place, a history and a friction of its own; they share the dataset. The results are exactly
 * those of single contacts, whatever the number of contacts and threads. One thread may call at a
 * time. */
typedef struct palpate_contacts palpate_contacts;

/* Output arrays for the touches of n contacts. The arrays belong to the caller; pass NULL for
 * unwanted ones. The values are exactly those of palpate_touch. */
typedef struct palpate_touches {
  size_t size;
  uint8_t* touching;     /* n, 1 or 0 */
  uint8_t* stepped;      /* n, 1 or 0 */
  uint8_t* inside;       /* n, 1 or 0 */
  int32_t* triangles;    /* n */
  double* forces;        /* 3 * n, N */
  double* stiffnesses;   /* 9 * n, N/m, row major */
  double* energies;      /* n, J */
  double* error_bounds;  /* n, N */
  double* coverages;     /* n */
  double* anchors;       /* 3 * n, m */
  double* normals;       /* 3 * n */
  double* displacements; /* 3 * n, m */
  double* gaps;          /* n, m */
  double* beyond;        /* n, m */
  double* drives;        /* 3 * n, N */
} palpate_touches;

/* Creates n contacts with the same options. options: NULL for the defaults; options->live must be
 * NULL (see palpate_contacts_follow). threads: number of threads that update them, including the
 * calling one; 0: one per core. The others sleep between calls. A contact needs 6 kB of memory.
 * Pass *contacts to palpate_contacts_destroy later; it is NULL on failure. */
PALPATE_API palpate_status palpate_contacts_create(const palpate_dataset* dataset,
                                                   const palpate_contact_options* options, size_t n,
                                                   int32_t threads, palpate_contacts** contacts);

/* Destroys the contacts and ends their threads; NULL is ignored. */
PALPATE_API void palpate_contacts_destroy(palpate_contacts* contacts);

/* Lets a live solver of this dataset follow contact number `index`; NULL: none. Ends the touch of
 * this contact. A live solver follows one contact at a time, and takes a core. Call
 * palpate_contacts_update every `period` of the live solvers. Errors: PALPATE_INVALID_ARGUMENT if
 * the contact does not exist, or if `live` is of another dataset or in use; the contact then has
 * none. */
PALPATE_API palpate_status palpate_contacts_follow(palpate_contacts* contacts, size_t index,
                                                   const palpate_live* live);

/* Sets the friction coefficients for later updates: n numbers, >= 0. If one is invalid, none
 * changes. */
PALPATE_API palpate_status palpate_contacts_set_frictions(palpate_contacts* contacts,
                                                          const double* frictions);

/* Runs one tick of all contacts, as palpate_contact_update does. tools: 3 * n numbers, m. holds: n
 * numbers, as `hold` there; NULL: all hold. A position that is not finite is no error: it ends its
 * contact, which has no force and inside = 0. Real time if there is one thread. */
PALPATE_API palpate_status palpate_contacts_update(palpate_contacts* contacts, const double* tools,
                                                   const uint8_t* holds,
                                                   const palpate_touches* touches);

/* Gives the state of contact number `index` after the last update, for the guard and for
 * palpate_touch_displacements. Real time. */
PALPATE_API palpate_status palpate_contacts_touch(const palpate_contacts* contacts, size_t index,
                                                  palpate_touch* touch);

/* Releases the contacts whose number in `mask` (n numbers) is not 0, as palpate_contact_release
 * does; NULL: all. For environments that start again: their tool may then be moved anywhere, and
 * touches again after an update outside the body. Real time. */
PALPATE_API palpate_status palpate_contacts_release(palpate_contacts* contacts,
                                                    const uint8_t* mask);

/* ---- live ---- */

/* A live solver solves for equilibria near the hand while the hand moves, in a process of its own
 * (palpate-worker). It corrects the forces of one contact, and allows a scene to be touched before
 * a dataset of it exists. docs/client.md describes its accuracy. */

typedef struct palpate_live_options {
  size_t size;
  double period; /* s, > 0: time between two calls of palpate_contact_update; default 0.001 */
  /* path of the program palpate-worker, which is started; NULL (default): found in PATH */
  const char* worker;
  /* address of a running `palpate follow`, "tcp://HOST:PORT"; NULL (default): start `worker` */
  const char* follower;
  /* folder of the keys for `follower`; NULL (default): the folder that `palpate key` uses; "":
   * no keys, for a follower that was started with --insecure */
  const char* keys;
} palpate_live_options;

typedef struct palpate_live_info {
  size_t size;
  int32_t ready;          /* 1: the live solver answers; 0: see palpate_live_trouble */
  int32_t reserved;       /* 0 */
  uint64_t answers;       /* number of equilibria received */
  uint64_t failures;      /* number of hand positions without an equilibrium */
  uint64_t restarts;      /* number of restarts and reconnections of the live solver */
  double mean_seconds;    /* s, mean time from question to answer; 0 before the first answer */
  double largest_seconds; /* s, largest time from question to answer */
} palpate_live_info;

/* Starts a live solver and waits until it has found the state at rest. scene: file of the scene
 * (.toml). dataset: the dataset of this scene that is corrected; NULL: a guess takes its place, a
 * spring everywhere, whose forces have inside = 0 and an error bound of at least their magnitude.
 * Takes seconds. options: NULL for the defaults. Pass *live to palpate_live_stop later; it is NULL
 * on failure. Errors: PALPATE_BAD_FILE for an invalid scene, follower or folder of keys, and if the
 * scene has no finger or is not that of the dataset; PALPATE_INVALID_ARGUMENT; PALPATE_FAILED if
 * the live solver does not start or cannot solve the scene. Threads and HDF5: as
 * palpate_dataset_open. */
PALPATE_API palpate_status palpate_live_start(const char* scene, const palpate_dataset* dataset,
                                              const palpate_live_options* options,
                                              palpate_live** live);

/* Ends the live solver; NULL is ignored. If a contact uses the live solver, the solver ends when
 * the contact is destroyed. */
PALPATE_API void palpate_live_stop(palpate_live* live);

/* A second finger, which holds the body while the contact touches it. It sticks to the surface at
 * `place` (m, at rest) and keeps the displacement `displacement` (m) there, also if it must pull.
 * Further calls move it and slide it over the surface. A jump of `place` or `displacement` by over
 * a quarter of the finger's radius is a new hold; place = NULL ends it. The contact feels a hold as
 * soon as the live solver has answered (`mean_seconds`). Only one thread may call these two
 * functions, which may be another one than that of the contact. Real time. palpate_live_hold_force
 * writes the force of the tissue on the hold, N, in the last update of the contact; NaN without a
 * hold, while the contact does not touch, and before the live solver has answered. Until then, and
 * if no finger can be at `place`, the error bound of the contact is at least its force. Errors:
 * PALPATE_INVALID_ARGUMENT for NULL in another place, and for numbers that are not finite. */
PALPATE_API palpate_status palpate_live_hold(palpate_live* live, const double place[3],
                                             const double displacement[3]);
PALPATE_API palpate_status palpate_live_hold_force(palpate_live* live, double force[3]);

/* Opens the dataset that the live solver corrects, for palpate_contact_create with options->live.
 * Pass *dataset to palpate_dataset_close later. Any thread. */
PALPATE_API palpate_status palpate_live_dataset(const palpate_live* live,
                                                palpate_dataset** dataset);

/* Describes the live solver in *info. Any thread. */
PALPATE_API palpate_status palpate_live_describe(const palpate_live* live, palpate_live_info* info);

/* Writes the current problem of the live solver into `text` as a sentence, truncated to `capacity`
 * bytes with the final zero; "" if there is none. During a problem, the solver is restarted or
 * asked again; the last equilibria correct forces up to a finger radius from them. Any thread. */
PALPATE_API palpate_status palpate_live_trouble(const palpate_live* live, char* text,
                                                size_t capacity);

/* ---- devices and the guard ---- */

/* Limits of a haptic device. */
typedef struct palpate_profile {
  size_t size;
  const char* name;        /* owned by the library */
  double max_force;        /* N */
  double max_stiffness;    /* N/m, the largest that the closed loop renders stably */
  double workspace_radius; /* m */
} palpate_profile;

/* Finds a device by name: "touch", "omni", "falcon", "omega", ... An unknown name is
 * PALPATE_INVALID_ARGUMENT, and the error text lists all known names. Any thread. */
PALPATE_API palpate_status palpate_device_profile(const char* name, palpate_profile* device);

/* Limits the force between a contact and a device. A guard limits the magnitude and rate of the
 * force, fades steps in, keeps the loop passive, and outputs zero if anything is wrong. No limit
 * can be switched off. */
typedef struct palpate_guard palpate_guard;

typedef struct palpate_guard_options {
  size_t size;
  double period;    /* s, > 0, period of the loop; default 0.001 */
  double max_force; /* N, > 0; default 3.3, the limit of the weakest known device */
  double max_slew;  /* N/s; 0 (default) or NaN: reaches max_force in 10 ms */
  double ramp;      /* s, > 0, over which a step of the force is faded in; default 0.05 */
  /* s, > 0: the force goes to zero after this time without a fresh reading; default 0.02 */
  double stall;
  double max_stiffness; /* N/m, > 0: limit of the device; default 400; has no effect at present */
  double energy_credit; /* J, >= 0: largest energy surplus or deficit kept; default 1e-4 */
  /* s, >= 0, at most 30 periods: time from the reading of a position until the force computed from
   * that position acts. Default 0: the force is sent within the period of the call and acts at
   * once */
  double delay;
} palpate_guard_options;

/* Flags of palpate_guard_limit that describe the reading. */
#define PALPATE_READING_FRESH 1u /* the position is new; if never set, the force is zero */
#define PALPATE_READING_LOST 2u  /* the device is gone: zero at once */
#define PALPATE_LOOP_LATE 4u     /* the loop hung before this tick: zero at once, then fades in */

/* Reasons why a force differs from the raw one: bits of palpate_guarded_force.guards. Only
 * append. */
#define PALPATE_GUARD_RAMPED 1u      /* a step of the force or a jump of the tool is faded in */
#define PALPATE_GUARD_DAMPED 2u      /* the hand would get back more energy than it put in */
#define PALPATE_GUARD_CLAMPED 4u     /* the force was longer than max_force */
#define PALPATE_GUARD_SLEWED 8u      /* the force would change faster than max_slew */
#define PALPATE_GUARD_STALLED 16u    /* no fresh reading for `stall` seconds */
#define PALPATE_GUARD_LOST 32u       /* the device is gone */
#define PALPATE_GUARD_NOT_FINITE 64u /* the position or the raw force was not finite */
#define PALPATE_GUARD_LATE 128u      /* the loop hung */
#define PALPATE_GUARD_BEYOND 256u    /* beyond the solved region: the raw force is a continuation */

typedef struct palpate_guarded_force {
  size_t size;
  double force[3]; /* N, finite, |force| <= max_force: send this to the device */
  /* J, energy put in by the hand minus energy stored in the tissue; negative: the loop created
   * energy */
  double passivity;
  uint32_t guards;   /* PALPATE_GUARD_... bits */
  uint32_t reserved; /* 0 */
} palpate_guarded_force;

/* Fills in options for a named device and a period (s, > 0). NULL for `device` gives the defaults
 * above. The caller sets options->size. Any thread. */
PALPATE_API palpate_status palpate_guard_defaults(const char* device, double period,
                                                  palpate_guard_options* options);

/* Creates a guard. options: NULL for the defaults. Pass *guard to palpate_guard_destroy later; it
 * is NULL on failure. */
PALPATE_API palpate_status palpate_guard_create(const palpate_guard_options* options,
                                                palpate_guard** guard);

/* Destroys the guard; NULL is ignored. */
PALPATE_API void palpate_guard_destroy(palpate_guard* guard);

/* Runs one tick and gives the force to send. Call it exactly once per period, also while nothing is
 * touched: it counts time in calls. tool: m, the position that the touch was computed from. touch:
 * of a contact, or filled in by a simulator with forces of its own; only size, touching, stepped,
 * force, stiffness and energy are read. flags: PALPATE_READING_FRESH, PALPATE_READING_LOST and
 * PALPATE_LOOP_LATE, or'ed; other bits are an error. After any status but PALPATE_OK the force in
 * *guarded is zero, if *guarded could be written: send that zero force. The next force is faded in
 * from zero. Real time. */
PALPATE_API palpate_status palpate_guard_limit(palpate_guard* guard, const double tool[3],
                                               const palpate_touch* touch, uint32_t flags,
                                               palpate_guarded_force* guarded);

/* Forgets all earlier ticks, as if the guard were new. Real time. */
PALPATE_API palpate_status palpate_guard_reset(palpate_guard* guard);

#ifdef __cplusplus
}
#endif

#endif /* PALPATE_H */
