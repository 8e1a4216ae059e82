/* Prints the structures and constants of palpate.h as this compiler lays them out, one per line;
 * compared with abi.txt. Compiled as strict C99: the header must be. */
#include <stdio.h>

#include "palpate.h"

#define STRUCT(name) printf("struct %s %zu\n", #name, sizeof(name))
#define MEMBER(name, member)                                               \
  printf("member %s.%s %zu %zu\n", #name, #member, offsetof(name, member), \
         sizeof(((name*)0)->member))
#define CONSTANT(name) printf("constant %s %ld\n", #name, (long)(name))

static void printConstants(void) {
  CONSTANT(PALPATE_ABI_VERSION);
  CONSTANT(PALPATE_OK);
  CONSTANT(PALPATE_INVALID_ARGUMENT);
  CONSTANT(PALPATE_BAD_FILE);
  CONSTANT(PALPATE_OUT_OF_MEMORY);
  CONSTANT(PALPATE_FAILED);
  CONSTANT(PALPATE_UNILATERAL);
  CONSTANT(PALPATE_GLUED);
  CONSTANT(PALPATE_MOST_SHARES);
  CONSTANT(PALPATE_READING_FRESH);
  CONSTANT(PALPATE_READING_LOST);
  CONSTANT(PALPATE_LOOP_LATE);
  CONSTANT(PALPATE_GUARD_RAMPED);
  CONSTANT(PALPATE_GUARD_DAMPED);
  CONSTANT(PALPATE_GUARD_CLAMPED);
  CONSTANT(PALPATE_GUARD_SLEWED);
  CONSTANT(PALPATE_GUARD_STALLED);
  CONSTANT(PALPATE_GUARD_LOST);
  CONSTANT(PALPATE_GUARD_NOT_FINITE);
  CONSTANT(PALPATE_GUARD_LATE);
  CONSTANT(PALPATE_GUARD_BEYOND);
}

int main(void) {
  printConstants();
  printf("type palpate_status %zu\n", sizeof(palpate_status));

  STRUCT(palpate_open_options);
  MEMBER(palpate_open_options, size);
  MEMBER(palpate_open_options, methods);
  MEMBER(palpate_open_options, method_count);
  MEMBER(palpate_open_options, reach);

  STRUCT(palpate_dataset_info);
  MEMBER(palpate_dataset_info, size);
  MEMBER(palpate_dataset_info, name);
  MEMBER(palpate_dataset_info, file);
  MEMBER(palpate_dataset_info, content_id);
  MEMBER(palpate_dataset_info, contact_mode);
  MEMBER(palpate_dataset_info, space_count);
  MEMBER(palpate_dataset_info, method_count);
  MEMBER(palpate_dataset_info, vertex_count);
  MEMBER(palpate_dataset_info, triangle_count);
  MEMBER(palpate_dataset_info, reserved);
  MEMBER(palpate_dataset_info, max_force);

  STRUCT(palpate_space_info);
  MEMBER(palpate_space_info, size);
  MEMBER(palpate_space_info, name);
  MEMBER(palpate_space_info, node);
  MEMBER(palpate_space_info, vertex);
  MEMBER(palpate_space_info, rest_position);
  MEMBER(palpate_space_info, workspace_radius);
  MEMBER(palpate_space_info, spacing);
  MEMBER(palpate_space_info, largest_force);

  STRUCT(palpate_sample);
  MEMBER(palpate_sample, size);
  MEMBER(palpate_sample, force);
  MEMBER(palpate_sample, stiffness);
  MEMBER(palpate_sample, energy);
  MEMBER(palpate_sample, error_bound);
  MEMBER(palpate_sample, coverage);
  MEMBER(palpate_sample, inside);
  MEMBER(palpate_sample, reserved);

  STRUCT(palpate_answers);
  MEMBER(palpate_answers, size);
  MEMBER(palpate_answers, forces);
  MEMBER(palpate_answers, stiffnesses);
  MEMBER(palpate_answers, energies);
  MEMBER(palpate_answers, error_bounds);
  MEMBER(palpate_answers, coverages);
  MEMBER(palpate_answers, inside);
  MEMBER(palpate_answers, drives);
  MEMBER(palpate_answers, places);
  MEMBER(palpate_answers, triangles);
  MEMBER(palpate_answers, distances);

  STRUCT(palpate_area_info);
  MEMBER(palpate_area_info, size);
  MEMBER(palpate_area_info, name);
  MEMBER(palpate_area_info, finger_radius);
  MEMBER(palpate_area_info, workspace_radius);
  MEMBER(palpate_area_info, site_count);
  MEMBER(palpate_area_info, reserved);

  STRUCT(palpate_area_sample);
  MEMBER(palpate_area_sample, size);
  MEMBER(palpate_area_sample, force);
  MEMBER(palpate_area_sample, stiffness);
  MEMBER(palpate_area_sample, drive);
  MEMBER(palpate_area_sample, at);
  MEMBER(palpate_area_sample, energy);
  MEMBER(palpate_area_sample, error_bound);
  MEMBER(palpate_area_sample, coverage);
  MEMBER(palpate_area_sample, inside);
  MEMBER(palpate_area_sample, triangle);
  MEMBER(palpate_area_sample, distance);

  STRUCT(palpate_contact_options);
  MEMBER(palpate_contact_options, size);
  MEMBER(palpate_contact_options, mode);
  MEMBER(palpate_contact_options, method);
  MEMBER(palpate_contact_options, friction);
  MEMBER(palpate_contact_options, grab_distance);
  MEMBER(palpate_contact_options, most_slide);
  MEMBER(palpate_contact_options, most_relaxation);

  STRUCT(palpate_touch);
  MEMBER(palpate_touch, size);
  MEMBER(palpate_touch, touching);
  MEMBER(palpate_touch, stepped);
  MEMBER(palpate_touch, inside);
  MEMBER(palpate_touch, triangle);
  MEMBER(palpate_touch, force);
  MEMBER(palpate_touch, stiffness);
  MEMBER(palpate_touch, energy);
  MEMBER(palpate_touch, error_bound);
  MEMBER(palpate_touch, coverage);
  MEMBER(palpate_touch, barycentric);
  MEMBER(palpate_touch, anchor);
  MEMBER(palpate_touch, normal);
  MEMBER(palpate_touch, displacement);
  MEMBER(palpate_touch, gap);
  MEMBER(palpate_touch, share_count);
  MEMBER(palpate_touch, share_spaces);
  MEMBER(palpate_touch, share_weights);
  MEMBER(palpate_touch, beyond);

  STRUCT(palpate_profile);
  MEMBER(palpate_profile, size);
  MEMBER(palpate_profile, name);
  MEMBER(palpate_profile, max_force);
  MEMBER(palpate_profile, max_stiffness);
  MEMBER(palpate_profile, workspace_radius);

  STRUCT(palpate_guard_options);
  MEMBER(palpate_guard_options, size);
  MEMBER(palpate_guard_options, period);
  MEMBER(palpate_guard_options, max_force);
  MEMBER(palpate_guard_options, max_slew);
  MEMBER(palpate_guard_options, ramp);
  MEMBER(palpate_guard_options, stall);
  MEMBER(palpate_guard_options, max_stiffness);
  MEMBER(palpate_guard_options, energy_credit);
  MEMBER(palpate_guard_options, delay);

  STRUCT(palpate_guarded_force);
  MEMBER(palpate_guarded_force, size);
  MEMBER(palpate_guarded_force, force);
  MEMBER(palpate_guarded_force, passivity);
  MEMBER(palpate_guarded_force, guards);
  MEMBER(palpate_guarded_force, reserved);
  return 0;
}
