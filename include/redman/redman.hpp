// redman/redman.hpp: C++17 for the stable headers. Classes that own a handle and destroy it,
// views of buffers, exceptions; no behaviour of its own. What a call does, needs and returns is
// described in the C header of the same name. What is for experimental headers is in sense.hpp,
// map.hpp, plan.hpp, shield.hpp, memory.hpp, record.hpp and team.hpp.
//
//   redman::Pool pool(redman::pool_config("hand_over_safe_finger", 16));
//   pool.reset();
//   for (;;) {
//     pool.baseline(RDM_BASELINE_RANDOM);  pool.step();  use(pool.obs()[i], pool.reward()[i]);
//   }
//
// Everything throws redman::Error, with the code and the text of the library. Owners can be moved,
// not copied; a moved-from owner may only be destroyed or assigned to.
#ifndef REDMAN_HPP
#define REDMAN_HPP
#include <redman/redman.h>

#include <redman/agent.hpp>
#include <redman/policy.hpp>
#include <redman/pool.hpp>
#endif
