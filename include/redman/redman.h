/* redman/redman.h: safe dexterous manipulation in a C library. Includes the stable headers, and
 * with RDM_EXPERIMENTAL the others.
 *
 * A pool steps N worlds of one task and writes observations, rewards, costs and end flags into
 * buffers; an agent acts on and learns from such buffers, of a pool or of your own environment; a
 * policy is the frozen network, loadable on a machine that has nothing else.
 *
 *   rdm_pool_config c;  rdm_pool *p;  rdm_buffers b = {.struct_size = sizeof b};
 *   rdm_pool_config_init(&c, sizeof c);
 *   c.task = "hand_over_safe_finger";  c.num_envs = 16;
 *   if (rdm_pool_create(&p, &c)) puts(rdm_last_error());
 *   rdm_pool_get_buffers(p, &b);
 *   rdm_pool_reset(p, NULL, NULL);
 *   for (...) { fill b.action;  rdm_pool_step(p);  read b.obs, b.reward, b.cost, ... }
 *   rdm_pool_destroy(p);
 *
 * Rules that hold for every function:
 *   - Fallible functions return rdm_result: 0 is good, negative is bad; nothing else is written
 *     then, unless noted. They never print, exit, abort or throw. The text of a failure is
 *     rdm_last_error() of the calling thread, for calls on a pool or an agent also
 *     rdm_pool_error(p) or rdm_agent_error(a) (where a call takes both: the agent's), and names the
 *     argument and its range.
 *   - Handles are made through `out` and ended by a void destroy function that takes NULL.
 *   - A pool or an agent may be used by one thread at a time, whichever it is; the _cancel and
 *     _error functions by any thread at any time. A policy may be shared by threads: it changes by
 *     rdm_policy_update_from alone. Functions without a handle may be called by any number of
 *     threads.
 *   - Only one call at a time may change a pool, agent, actor, planner, shield, recording or map.
 *     While none does, any number of calls that take it as `const` may read it (an agent excepted).
 *     A call that is made while another one is in progress returns STATE and does nothing, be it
 *     from a second thread or from a callback or hook that runs for this handle; its text is in
 *     rdm_last_error() alone. A rollout occupies its agent and its pool; a plan occupies its
 *     planner and the agent of its critic, and reads its pool. Destroying a handle during a call
 *     does nothing either, and the handle's log hook is told: destroy it again afterwards.
 *   - fork: in the child process, calls that need a handle's own threads (num_threads above 1 and
 *     no parallel hook) return STATE, and the handle can be destroyed; all other handles work as in
 *     the parent.
 *   - A handle of another kind is an ARGUMENT, and so is a destroyed one as long as its memory has
 *     not been used again; destroying either does nothing.
 *   - A struct begins with struct_size, the sizeof of the struct that you compiled with, unless its
 *     comment says "frozen layout": set it yourself or by the _init function. ARGUMENT for a size
 *     below that of the first version or above 4096, and for a reserved member that is not 0.
 *   - Robots, objects and tasks, the library's own and those of a host, are identified by numbers.
 *     The number of one that was destroyed gives NOT_FOUND everywhere, and is not used again before
 *     2^31 others were made; its memory is freed. To list all, ask for 0 to _count() - 1 and skip
 *     those that are NOT_FOUND.
 *   - Returned strings live as long as their handle; those of tasks, algorithms, robots and objects
 *     live as long as the process, even after these are destroyed (equal strings are kept once).
 *     They are UTF-8; bytes of a given name that are not UTF-8 are printed as \xNN.
 *   - Arrays are row-major. SI units, radians. Quaternions are (x, y, z, w) here and in
 *     observations.
 *   - The same seed gives the same bytes for any number of threads: of worlds on every
 *     little-endian machine whose ODE and libccd were compiled without fused multiply-adds (see
 *     rdm_build.differs), of learners on every machine with the same rdm_build.kernels.
 *
 * Naming: create and destroy begin and end a handle; read and write are for bytes and files, get
 * and set for values that are copied; _at(i) gives row i of a list, and RANGE past its end
 * (_option_at: what an option is, _setting_at: its value); _config_ functions say what a config
 * would give, without making it. A name that changes stays in deprecated.h for one minor release.
 *
 * Promises of 1.x, from 1.0 on. A program that was compiled against the stable headers of 1.a runs
 * with the library of every 1.b, b >= a, and compiles with its headers, except for names that were
 * deprecated a minor release before. Functions, enumerators and members at the ends of structs may
 * be added. Policies, states of agents, checkpoints, recordings, maps and robot files that 1.a
 * wrote are read by every 1.b, b >= a; states of worlds only by the version that wrote them. Not
 * promised: the texts of errors, the order of options in a list, the same bytes of results in
 * another version. Experimental headers may change in any minor release, and the loader refuses a
 * program that was compiled for another one.
 *
 * How to read the declarations, for generators of bindings (tests/rules/check_contract.py holds
 * them to it):
 *   - `const T *x` is read, `T *x` is written. `x [rows][obs_dim]` in the comment of the function,
 *     or `[rows][obs_dim]` first in the comment of a member, makes x an array of that shape;
 *     without one it is a single value. A function's comment is the text behind it, then the text
 *     above the group of functions that it is in.
 *   - Words in a shape are arguments of the function, members of structs, or macros; n0 is the
 *     first number of n.
 *   - An array whose comment says so may be NULL; a struct with struct_size that is not a config is
 *     both input and output.
 *   - `const char *` is a text that ends in 0. `rdm_pool *`, `rdm_agent *`, `rdm_policy *`,
 *     `rdm_actor *`, `rdm_recording *`, `rdm_planner *`, `rdm_shield *`, `rdm_map *`,
 *     `rdm_import *`, `rdm_scene *` and `rdm_world *` are handles, through `**` new ones. `void *`
 *     with a shape is bytes; other ones are passed through.
 *   - Text and bytes of any length come as (T *x, size_t capacity, size_t *size): x NULL asks for
 *     the size alone, a capacity below it is RANGE. The size of a text is without its 0, which the
 *     capacity must count.
 * / */
#ifndef REDMAN_H
#define REDMAN_H
#include <redman/base.h>   /* results, version, hooks, options          stable since 1.0 */
#include <redman/policy.h> /* the frozen network                        stable since 1.0 */
#include <redman/pool.h>   /* what exists, and worlds of one task       stable since 1.0 */
#include <redman/agent.h>  /* one algorithm that acts and learns        stable since 1.0 */
#endif

/* These headers may change in any minor release. To get them, #define RDM_EXPERIMENTAL before the
 * #include, also in a file that has included the stable ones before; or include one of them by its
 * name. */
#if defined(RDM_EXPERIMENTAL)
#include <redman/sense.h>  /* what worlds observe, and policies that read points         */
#include <redman/map.h>    /* what is occupied, free and unknown in space                */
#include <redman/plan.h>   /* actors and planners, which choose actions without learning */
#include <redman/shield.h> /* shields, which keep costs within their budgets             */
#include <redman/memory.h> /* agents and policies that remember                          */
#include <redman/record.h> /* trajectories as data, and what is learned from them        */
#include <redman/ranks.h>  /* learning in several processes together                     */
#include <redman/team.h>   /* several policies that act together                         */
#include <redman/robot.h>  /* robots of your own                                         */
#include <redman/object.h> /* objects of your own                                        */
#include <redman/task.h>   /* tasks of your own                                          */
#endif

/* The names of 0.1, which are deprecated. */
#if !defined(RDM_NO_DEPRECATED)
#include <redman/deprecated.h>
#endif
