// The functions of 0.1 that have another name now, for programs that were linked with it: the same arguments, the same
// answers. They live as long as RDM_ABI; redman/deprecated.h has them for sources.
#include "redman/redman.h"

extern "C" {

#if RDM_WITH_POLICY || RDM_STUBS
RDM_API rdm_result rdm_policy_load(rdm_policy** out, const void* bytes, size_t size) {
  return rdm_policy_read(out, bytes, size);
}
RDM_API rdm_result rdm_policy_load_file(rdm_policy** out, const char* path) {
  return rdm_policy_read_file(out, path);
}
RDM_API rdm_result rdm_policy_tensor(const rdm_policy* p, int32_t i, rdm_tensor* out) {
  return rdm_policy_tensor_at(p, i, out);
}
RDM_API rdm_result rdm_policy_tensor_read(const rdm_policy* p, const char* name, float* out, size_t count) {
  return rdm_policy_get_tensor(p, name, out, count);
}
#endif

#if RDM_WITH_SIM || RDM_STUBS
RDM_API rdm_result rdm_task_default(int32_t task, int32_t i, rdm_option* out) {
  return rdm_task_default_at(task, i, out);
}
RDM_API rdm_result rdm_pool_spec(const rdm_pool_config* c, rdm_spec* io) {
  return rdm_pool_config_spec(c, io);
}
RDM_API rdm_result rdm_pool_memory(const rdm_pool_config* c, size_t* ours, size_t* engines) {
  return rdm_pool_config_memory(c, ours, engines);
}
RDM_API rdm_result rdm_pool_initial_mean(const rdm_pool* p, float* action) {
  return rdm_pool_get_initial_mean(p, action);
}
RDM_API rdm_result rdm_pool_option(const rdm_pool* p, int32_t i, const char** key, char* text) {
  return rdm_pool_option_at(p, i, key, text);
}
RDM_API rdm_result rdm_pool_settings(const rdm_pool* p, char* text, size_t capacity, size_t* size) {
  return rdm_pool_get_settings(p, text, capacity, size);
}
RDM_API rdm_result rdm_pool_buffers(const rdm_pool* p, rdm_buffers* io) {
  return rdm_pool_get_buffers(p, io);
}
RDM_API rdm_result rdm_pool_bind(rdm_pool* p, const rdm_buffers* b) {
  return rdm_pool_set_buffers(p, b);
}
RDM_API rdm_result rdm_pool_get_state(const rdm_pool* p, int32_t env, void* bytes, size_t capacity,
                                      size_t* size) {
  return rdm_pool_write_state(p, env, bytes, capacity, size);
}
RDM_API rdm_result rdm_pool_set_state(rdm_pool* p, int32_t env, const void* bytes, size_t size) {
  return rdm_pool_read_state(p, env, bytes, size);
}
RDM_API rdm_result rdm_pool_hash(const rdm_pool* p, int32_t env, uint64_t* hash) {
  return rdm_pool_get_hash(p, env, hash);
}
#endif

#if RDM_WITH_LEARN || RDM_STUBS
RDM_API rdm_result rdm_agent_memory(const rdm_agent_config* c, size_t* bytes) {
  return rdm_agent_config_memory(c, bytes);
}
RDM_API rdm_result rdm_agent_set(rdm_agent* a, const rdm_option* option) {
  return rdm_agent_set_option(a, option);
}
RDM_API rdm_result rdm_agent_option(const rdm_agent* a, int32_t i, const char** key, char* text) {
  return rdm_agent_option_at(a, i, key, text);
}
RDM_API rdm_result rdm_agent_settings(const rdm_agent* a, char* text, size_t capacity, size_t* size) {
  return rdm_agent_get_settings(a, text, capacity, size);
}
RDM_API rdm_result rdm_agent_tensor(const rdm_agent* a, int32_t i, rdm_tensor* out) {
  return rdm_agent_tensor_at(a, i, out);
}
RDM_API rdm_result rdm_agent_tensor_read(const rdm_agent* a, const char* name, float* out, size_t count) {
  return rdm_agent_get_tensor(a, name, out, count);
}
RDM_API rdm_result rdm_agent_tensor_write(rdm_agent* a, const char* name, const float* values, size_t count) {
  return rdm_agent_set_tensor(a, name, values, count);
}
RDM_API rdm_result rdm_agent_policy(const rdm_agent* a, void* bytes, size_t capacity, size_t* size) {
  return rdm_agent_write_policy(a, bytes, capacity, size);
}
RDM_API rdm_result rdm_agent_policy_file(const rdm_agent* a, const char* path) {
  return rdm_agent_write_policy_file(a, path);
}
RDM_API rdm_result rdm_agent_save(const rdm_agent* a, void* bytes, size_t capacity, size_t* size) {
  return rdm_agent_write_state(a, bytes, capacity, size);
}
RDM_API rdm_result rdm_agent_load(rdm_agent* a, const void* bytes, size_t size) {
  return rdm_agent_read_state(a, bytes, size);
}
#endif
}
