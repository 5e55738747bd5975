// redman_points.hpp: the name of <redman/sense.hpp> before 1.0, with all experimental headers.
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/redman.hpp>
#include <redman/sense.hpp>
