/* redman_map.h: maps are in the experimental part of redman.h. */
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>
