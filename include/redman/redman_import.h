/* redman_import.h: the name of <redman/import.h> before 1.0, with all experimental headers. */
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>
#include <redman/import.h>
