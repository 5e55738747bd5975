// redman_actor.hpp: the name of <redman/plan.hpp> before 1.0, with all experimental headers.
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/plan.hpp>
#include <redman/redman.hpp>
