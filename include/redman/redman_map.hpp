// redman_map.hpp: the name of <redman/map.hpp> and <redman/sense.hpp> before 1.0, with all
// experimental headers.
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/map.hpp>
#include <redman/redman.hpp>
#include <redman/sense.hpp>
