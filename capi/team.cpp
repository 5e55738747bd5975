// rdm_policy_group*: the policies of a team, one for each group of actions.

#include "capi/handles.hpp"

#if RDM_WITH_POLICY
using namespace rdm;
using namespace rdm::capi;

const char* rdm_policy_group_name(const rdm_policy* p, int32_t i) {
  if (!is_handle(p)) return nullptr;
  const PolicyView& v = p->policy->view();
  return i >= 0 && i < v.num_groups ? v.group[i].name : nullptr;
}

rdm_result rdm_policy_write_group(const rdm_policy* p, int32_t i, void* bytes, size_t capacity,
                                  size_t* size) {
  return call([&] {
    need_handle(p);
    const PolicyView& v = p->policy->view();
    if (v.num_groups == 0) fail(Code::kState, "policy: it has no groups; it is one network");
    need_index(i, v.num_groups, "i");
    emit(bytes, capacity, size, [&](Writer& w) { write_group(w, v, i); });
  });
}
#endif
