/* redman_sense.h: what worlds see are in the experimental part of redman.h. */
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>
