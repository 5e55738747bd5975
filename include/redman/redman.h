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
 *   - A pool and an agent: one thread at a time, not bound to a thread; the _cancel and _error
 *     functions from any. A policy: immutable, shared freely. What takes no handle: any
 *     number of threads.
 *   - One call at a time changes a pool, agent, planner, recording or map; while none does, any
 *     number read one (take it as `const`; an agent never). A call that comes while another is
 *     within is STATE, and does nothing: of a second thread, or of a callback or hook on the handle
 *     that it is called for. Its text is rdm_last_error() alone. A rollout is within its agent and
 *     its pool, a plan within its planner and its critic's agent, and reads its pool. To destroy a
 *     handle while a call is within does nothing either, and the log hook of the handle is told:
 *     destroy it once more afterwards.
 *   - fork: in the child, handles with threads of their own (num_threads above 1 and no parallel
 *     hook) answer STATE to what needs those, and can be destroyed; all others continue as
 *     in the parent.
 *   - A handle of another kind, or one that was destroyed and whose memory has not been used since,
 *     is an ARGUMENT; to destroy such a one does nothing.
 *   - Structs begin with struct_size = sizeof of your version: set it yourself or through the _init
 *     function. ARGUMENT for less than the first version had or more than 4096, and for a reserved
 *     member that is not 0.
 *   - Robots, objects and tasks go by number, the library's own and those of a host. The number of
 *     one that was destroyed is NOT_FOUND wherever it is given, and no other one's before 2^31 more
 *     were made; what it took is free again. To see all, look at 0 to _count() - 1 and pass over
 *     NOT_FOUND.
 *   - Strings that are returned live as long as their handle (those of tasks, algorithms, robots
 *     and objects: as long as the process, also where these are destroyed; equal ones are kept
 *     once). UTF-8; what is no UTF-8 in a given name is printed as \xNN.
 *   - Arrays are row-major. SI units, radians. Quaternions are (x, y, z, w) here and in
 *     observations.
 *   - Same seed, same bytes: for any number of threads; worlds on every little-endian machine whose
 *     ODE and libccd were compiled without fused multiply-adds (rdm_build.differs), learners on
 *     every machine with the same rdm_build.kernels.
 *
 * Words: create and destroy make and end; read and write are for bytes and files, get and set for
 * values that are copied; _at(i) is row i of a list, which RANGE ends (_option_at: what an option
 * is, _setting_at: what it is set to); _config_ functions answer what a config would give. A name
 * that changes is kept in deprecated.h for one minor release.
 *
 * Promises of 1.x, from 1.0 on. A program that was compiled against the stable headers of 1.a runs
 * with the library of every 1.b, b >= a, and compiles with its headers, but for names that were
 * deprecated one minor release before. Functions, enumerators and members at the ends of structs
 * may be added. Policies, states of agents, checkpoints, recordings, maps and robot files that 1.a
 * wrote are read by every 1.b, b >= a; states of worlds by the version that wrote them. No promise:
 * the texts of errors, the order of options in a list, results to the byte beyond one version.
 * Experimental headers may change in any minor release, and the loader refuses a program of another
 * one.
 *
 * How to read the declarations, for generators of bindings (tests/rules/check_contract.py holds
 * them to it):
 *   - `const T *x` is read, `T *x` is written. `x [rows][obs_dim]` in the comment of the function,
 *     or `[rows][obs_dim]` first in the comment of a member, makes x an array of that shape;
 *     without one it is a single value. A function's comment is what stands behind it, then what
 *     stands above the run of functions that it is in.
 *   - Words in a shape are arguments of the function, members of structs, or macros; n0 is the
 *     first number of n.
 *   - An array whose comment says so may be NULL; a struct with struct_size that is no config is in
 *     and out.
 *   - `const char *` is a text that ends in 0. `rdm_pool *`, `rdm_agent *`, `rdm_policy *`,
 *     `rdm_actor *`, `rdm_recording *`, `rdm_planner *`, `rdm_shield *`, `rdm_map *`,
 *     `rdm_scene *` and `rdm_world *` are handles, through `**` new ones. `void *` with a shape is
 *     bytes; other ones are passed through.
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

/* What may change in any minor release. #define RDM_EXPERIMENTAL before the #include to see it, in
 * a file that has seen the rest before, too; to include one of these by its name is enough. */
#if defined(RDM_EXPERIMENTAL)
#include <redman/sense.h>  /* what worlds observe, and policies that read points         */
#include <redman/map.h>    /* what is occupied, free and unknown in space                */
#include <redman/plan.h>   /* actors and planners, which choose actions without learning */
#include <redman/shield.h> /* under which no cost exceeds its budget                     */
#include <redman/record.h> /* trajectories as data, and what is learned from them        */
#include <redman/ranks.h>  /* one learner of many processes                              */
#include <redman/robot.h>  /* robots of your own                                         */
#include <redman/object.h> /* objects of your own                                        */
#include <redman/task.h>   /* tasks of your own                                          */
#endif

/* The names of 0.1, which are deprecated. */
#if !defined(RDM_NO_DEPRECATED)
#include <redman/deprecated.h>
#endif
