# This machine by its own compilers, for static libraries where the distribution has shared ones alone.
