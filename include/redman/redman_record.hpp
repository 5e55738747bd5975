// redman_record.hpp: the name of <redman/record.hpp> before 1.0, with all experimental headers.
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <redman/record.hpp>
#include <redman/redman.hpp>
