// The functions of a half that was left out of the build: they exist and say so.
#include "capi/abi_call.hpp"
#include "redman/redman_map.h"
#include "redman/redman_sense.h"

using namespace rdm;
using namespace rdm::capi;

#define RDM_ABSENT(half, name, parameters)        \
  rdm_result name parameters {                    \
    return call(nullptr, [] { left_out(half); }); \
  }
#define RDM_SIM_ABSENT(name, ...) RDM_ABSENT("simulation", name, (__VA_ARGS__))
#define RDM_LEARN_ABSENT(name, ...) RDM_ABSENT("learning", name, (__VA_ARGS__))

#if !RDM_WITH_SIM
int32_t rdm_task_count(void) {
  return 0;
}
int32_t rdm_robot_count(void) {
  return 0;
}
int32_t rdm_object_count(void) {
  return 0;
}
void rdm_pool_destroy(rdm_pool*) {}
const char* rdm_pool_error(const rdm_pool*) {
  return "this build was made without the simulation half";
}
void rdm_map_destroy(rdm_map*) {}
const char* rdm_map_error(const rdm_map*) {
  return "this build was made without the simulation half";
}
size_t rdm_sample_scratch(int32_t) {
  return 0;
}
RDM_SIM_ABSENT(rdm_pool_sensors, const rdm_pool*, rdm_sensors*)
RDM_SIM_ABSENT(rdm_pool_hull, const rdm_pool*, int32_t, float*, int32_t, int32_t*)
RDM_SIM_ABSENT(rdm_pool_sensor_camera, const rdm_pool*, int32_t, int32_t, rdm_camera*)
RDM_SIM_ABSENT(rdm_sample_furthest, const float*, int32_t, int32_t, int32_t, int32_t*, void*, size_t)
RDM_SIM_ABSENT(rdm_map_config_init, rdm_map_config*, size_t)
RDM_SIM_ABSENT(rdm_map_create, rdm_map**, const rdm_map_config*)
RDM_SIM_ABSENT(rdm_map_get_info, const rdm_map*, rdm_map_info*)
RDM_SIM_ABSENT(rdm_map_clear, rdm_map*)
RDM_SIM_ABSENT(rdm_map_insert, rdm_map*, const float*, const float*, size_t, uint64_t*)
RDM_SIM_ABSENT(rdm_map_scan, rdm_map*, rdm_pool*, int32_t, const char*, int32_t, int32_t, const int32_t*,
               int32_t, uint64_t*)
RDM_SIM_ABSENT(rdm_map_query, const rdm_map*, const float*, size_t, float*)
RDM_SIM_ABSENT(rdm_map_box, const rdm_map*, const float*, const float*, rdm_voxel*, size_t, size_t*)
RDM_SIM_ABSENT(rdm_map_meets, const rdm_map*, const float*, const float*, int32_t*)
RDM_SIM_ABSENT(rdm_map_raycast, const rdm_map*, const float*, const float*, float, int32_t, float*, int32_t*)
RDM_SIM_ABSENT(rdm_map_distance, const rdm_map*, const float*, size_t, float, float*)
RDM_SIM_ABSENT(rdm_map_grid, const rdm_map*, const float*, const int32_t*, float, int8_t*)
RDM_SIM_ABSENT(rdm_map_save, const rdm_map*, int32_t, void*, size_t, size_t*)
RDM_SIM_ABSENT(rdm_map_save_file, const rdm_map*, const char*)
RDM_SIM_ABSENT(rdm_map_load, rdm_map*, const void*, size_t)
RDM_SIM_ABSENT(rdm_map_load_file, rdm_map*, const char*)
RDM_SIM_ABSENT(rdm_task_at, int32_t, rdm_task*)
RDM_SIM_ABSENT(rdm_task_find, const char*, int32_t*)
RDM_SIM_ABSENT(rdm_task_field, int32_t, int32_t, rdm_field*)
RDM_SIM_ABSENT(rdm_task_cost, int32_t, int32_t, rdm_cost*)
RDM_SIM_ABSENT(rdm_task_option, int32_t, int32_t, rdm_option_info*)
RDM_SIM_ABSENT(rdm_task_camera, int32_t, int32_t, rdm_camera*)
RDM_SIM_ABSENT(rdm_task_default, int32_t, int32_t, rdm_option*)
RDM_SIM_ABSENT(rdm_robot_at, int32_t, rdm_robot*)
RDM_SIM_ABSENT(rdm_robot_joint, int32_t, int32_t, rdm_joint*)
RDM_SIM_ABSENT(rdm_object_at, int32_t, rdm_object*)
RDM_SIM_ABSENT(rdm_pool_spec, const rdm_pool_config*, rdm_spec*)
RDM_SIM_ABSENT(rdm_pool_memory, const rdm_pool_config*, size_t*, size_t*)
RDM_SIM_ABSENT(rdm_pool_create, rdm_pool**, const rdm_pool_config*)
RDM_SIM_ABSENT(rdm_pool_get_spec, const rdm_pool*, rdm_spec*)
RDM_SIM_ABSENT(rdm_pool_field, const rdm_pool*, int32_t, rdm_field*)
RDM_SIM_ABSENT(rdm_pool_option, const rdm_pool*, int32_t, const char**, char*)
RDM_SIM_ABSENT(rdm_pool_buffers, const rdm_pool*, rdm_buffers*)
RDM_SIM_ABSENT(rdm_pool_bind, rdm_pool*, const rdm_buffers*)
RDM_SIM_ABSENT(rdm_pool_reset, rdm_pool*, const uint64_t*, const uint8_t*)
RDM_SIM_ABSENT(rdm_pool_step, rdm_pool*)
RDM_SIM_ABSENT(rdm_pool_step_masked, rdm_pool*, const uint8_t*)
RDM_SIM_ABSENT(rdm_pool_baseline, rdm_pool*, int32_t)
RDM_SIM_ABSENT(rdm_pool_state_size, const rdm_pool*, int32_t, size_t*)
RDM_SIM_ABSENT(rdm_pool_get_state, const rdm_pool*, int32_t, void*, size_t, size_t*)
RDM_SIM_ABSENT(rdm_pool_set_state, rdm_pool*, int32_t, const void*, size_t)
RDM_SIM_ABSENT(rdm_pool_hash, const rdm_pool*, int32_t, uint64_t*)
RDM_SIM_ABSENT(rdm_pool_shape, const rdm_pool*, int32_t, rdm_shape*)
RDM_SIM_ABSENT(rdm_pool_poses, const rdm_pool*, int32_t, float*)
RDM_SIM_ABSENT(rdm_pool_contacts, const rdm_pool*, int32_t, rdm_contact*, int32_t, int32_t*)
RDM_SIM_ABSENT(rdm_pool_render, rdm_pool*, int32_t, const char*, int32_t, int32_t, uint8_t*, float*, int32_t*)
RDM_SIM_ABSENT(rdm_pool_get_stats, const rdm_pool*, rdm_pool_stats*)
RDM_SIM_ABSENT(rdm_pool_push, rdm_pool*, int32_t, int32_t, const float*)
#endif

#if !RDM_WITH_LEARN
int32_t rdm_algo_count(void) {
  return 0;
}
void rdm_agent_destroy(rdm_agent*) {}
void rdm_agent_cancel(rdm_agent*) {}
void rdm_policy_destroy(rdm_policy*) {}
size_t rdm_policy_scratch(const rdm_policy*, int32_t) {
  return 0;
}
const char* rdm_agent_error(const rdm_agent*) {
  return "this build was made without the learning half";
}
RDM_LEARN_ABSENT(rdm_algo_at, int32_t, rdm_algo*)
RDM_LEARN_ABSENT(rdm_algo_find, const char*, int32_t*)
RDM_LEARN_ABSENT(rdm_algo_option, int32_t, int32_t, rdm_option_info*)
RDM_LEARN_ABSENT(rdm_agent_memory, const rdm_agent_config*, size_t*)
RDM_LEARN_ABSENT(rdm_agent_create, rdm_agent**, const rdm_agent_config*)
RDM_LEARN_ABSENT(rdm_agent_act, rdm_agent*, const float*, int32_t, float*)
RDM_LEARN_ABSENT(rdm_agent_record, rdm_agent*, const rdm_transition*)
RDM_LEARN_ABSENT(rdm_agent_update, rdm_agent*, const float*, rdm_epoch*)
RDM_LEARN_ABSENT(rdm_agent_set, rdm_agent*, const rdm_option*)
RDM_LEARN_ABSENT(rdm_agent_option, const rdm_agent*, int32_t, const char**, char*)
RDM_LEARN_ABSENT(rdm_agent_tensor, const rdm_agent*, int32_t, rdm_tensor*)
RDM_LEARN_ABSENT(rdm_agent_tensor_read, const rdm_agent*, const char*, float*, size_t)
RDM_LEARN_ABSENT(rdm_agent_tensor_write, rdm_agent*, const char*, const float*, size_t)
RDM_LEARN_ABSENT(rdm_agent_policy, const rdm_agent*, void*, size_t, size_t*)
RDM_LEARN_ABSENT(rdm_agent_policy_file, const rdm_agent*, const char*)
RDM_LEARN_ABSENT(rdm_agent_save, const rdm_agent*, void*, size_t, size_t*)
RDM_LEARN_ABSENT(rdm_agent_load, rdm_agent*, const void*, size_t)
RDM_LEARN_ABSENT(rdm_policy_load, rdm_policy**, const void*, size_t)
RDM_LEARN_ABSENT(rdm_policy_load_file, rdm_policy**, const char*)
RDM_LEARN_ABSENT(rdm_policy_get_info, const rdm_policy*, rdm_policy_info*)
RDM_LEARN_ABSENT(rdm_policy_act, const rdm_policy*, const float*, int32_t, const float*, float*, void*,
                 size_t)
RDM_LEARN_ABSENT(rdm_policy_tensor, const rdm_policy*, int32_t, rdm_tensor*)
RDM_LEARN_ABSENT(rdm_policy_tensor_read, const rdm_policy*, const char*, float*, size_t)
RDM_LEARN_ABSENT(rdm_policy_check, const rdm_policy*, const rdm_spec*)
RDM_LEARN_ABSENT(rdm_checkpoint_write, const char*, const rdm_agent*, const rdm_pool*, const void*, size_t)
RDM_LEARN_ABSENT(rdm_checkpoint_read, const char*, rdm_agent*, rdm_pool*, void*, size_t, size_t*)
#endif

#if !(RDM_WITH_SIM && RDM_WITH_LEARN)
#define RDM_BOTH_ABSENT(name, ...) RDM_ABSENT(RDM_WITH_SIM ? "learning" : "simulation", name, (__VA_ARGS__))
RDM_BOTH_ABSENT(rdm_agent_config_for_pool, rdm_agent_config*, const rdm_pool*)
RDM_BOTH_ABSENT(rdm_agent_rollout, rdm_agent*, rdm_pool*, rdm_epoch*)
#endif
