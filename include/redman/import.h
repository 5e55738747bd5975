/* redman/import.h: robots and tasks out of files. Experimental.
 *
 * A library of its own, redman_import, beside redman.
 *
 * URDF, the kinematic subset of MJCF, and redman's own text format (.robot: TOML, 1:1 with
 * rdm_robot_def) become an rdm_robot_def; what a file holds beyond that is listed, each element
 * with its line.
 *
 *   rdm_import *i;  rdm_robot_def d;  int32_t robot;
 *   if (rdm_import_read_file(&i, "hand.urdf", NULL)) puts(rdm_import_error());  line and element
 *   rdm_robot_def_init(&d, sizeof d);
 *   rdm_import_get_robot_def(i, &d);
 *   rdm_robot_create(&robot, &d);
 *   rdm_import_destroy(i);
 *
 * Rules of redman.h hold. The text of a failure is rdm_import_error() of the calling thread. An
 * rdm_import does not change but in rdm_import_check; any number of threads may read it.
 *
 * What could change mass, pose, axis, range or coupling is read, or refused with the name of its
 * element; so is an element or attribute of URDF or MJCF that is not known. Dropped, each with a
 * note: what is seen alone, friction and softness of contacts, springs of joints and tendons,
 * limits of tendons that are wide, actuators that hold no joint (their effort is taken), sensors,
 * options of a simulator, soft limits of controllers, what other programs added to URDF for
 * themselves.
 *
 * What is done on the way: fixed joints and their links become part of what carries them; a mesh
 * becomes the smallest of box, capsule and sphere around its corners; a joint without an end gets
 * +-2 pi, rad or m (config.slide_range). Gains come from position actuators, else kp reaches the
 * effort 0.2 rad (20 mm) off the target and kd damps critically with the inertia that the joint
 * feels at home. What no such file says (palm, fingers, tips, mount, flange, poses) is guessed, the
 * same way each time, and listed. */
#ifndef REDMAN_IMPORT_H
#define REDMAN_IMPORT_H
#include <redman/task.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rdm_import rdm_import; /* handle */
enum rdm_import_format { /* of a file; AUTO looks at the first element */
  RDM_IMPORT_AUTO = 0,
  RDM_IMPORT_URDF = 1,
  RDM_IMPORT_MJCF = 2,
  RDM_IMPORT_ROBOT = 3
};
enum rdm_note_kind { /* of a note */
  RDM_NOTE_DROPPED = 0, /* in the file, not in the robot         */
  RDM_NOTE_CHANGED = 1, /* in the robot, in another form         */
  RDM_NOTE_GUESSED = 2, /* not in the file                       */
  RDM_NOTE_CHECK = 3    /* found by rdm_import_check             */
};
/* how a file is read; a .robot file takes no root, roles, density or slide_range: ARGUMENT */
typedef struct rdm_import_config {
  uint32_t struct_size;    /* bytes, set by rdm_import_config_init */
  int32_t format;          /* RDM_IMPORT_* */
  int32_t kind;            /* RDM_ROBOT_*, -1: guessed; default -1 */
  int32_t skip_meshes;     /* flag: meshes that cannot be read are dropped with a note, else
                            * refused */
  const char *name;        /* of the robot, which then has no alias; NULL: the file's */
  const char *folder;      /* where the names of a text's meshes begin; NULL: that of the file,
                            * or none */
  const char *packages;    /* folder that holds the folders of package://; NULL: searched above
                            * the file */
  const char *root;        /* link (body) whose subtree is taken, "world" for all of an MJCF
                            * file; NULL */
  const char *palm;        /* link; NULL: guessed */
  const char *tips;        /* links or sites, "a,b,c", one for each finger; NULL: guessed */
  const char *mount;       /* link or site, or "x y z roll pitch yaw" in the root frame; NULL:
                            * guessed */
  const char *flange;      /* link or site, "none"; NULL: guessed */
  char *error;             /* [error_size] the text of a failing call that takes this config;
                            * NULL */
  int32_t error_size;      /* bytes, terminator included; what is longer is cut */
  int32_t mend_inertia;    /* flag: moments that break the triangle rule are raised with a note,
                            * else refused */
  double density;          /* kg/m3, of URDF links without <inertial>: what their <collision>
                            * weighs; 0: they weigh nothing; above 0 with another format, where
                            * geoms say their own: ARGUMENT */
  double slide_range;      /* m to either side, of a joint that slides without an end; 0: 2 pi */
} rdm_import_config;
typedef struct rdm_import_note { /* frozen layout; texts live as long as the handle */
  int32_t kind;            /* RDM_NOTE_* */
  int32_t line;            /* of the file, from 1; 0: of none */
  const char *text;        /* one line, with the element and, in an included file, its name */
} rdm_import_note;
/* Fills the first `size` bytes with defaults. */
RDM_API rdm_result rdm_import_config_init(rdm_import_config *c, size_t size);
/* Reads a file; c may be NULL for the defaults. NOT_FOUND, IO; FORMAT: malformed, with its line;
 * ARGUMENT, RANGE: a robot that cannot be, with line and element; UNSUPPORTED: an element that
 * would change the robot and is not read. What is no regular file is IO and never waited for. A
 * file and all that it includes or names cost at most 4096 files, 16 MB of text, 512 MB of meshes
 * (64 MB each), 250,000 elements, 400,000 attributes and 10 million steps of work: RANGE beyond. */
RDM_API rdm_result rdm_import_read_file(rdm_import **out, const char *path,
                                        const rdm_import_config *c);
/* The same for bytes [size] of a file. Without config.folder it has neither meshes nor includes. */
RDM_API rdm_result rdm_import_read(rdm_import **out, const void *bytes, size_t size,
                                   const rdm_import_config *c);
/* A robot that is there, the library's own too, as a handle that can be written. */
RDM_API rdm_result rdm_import_create_robot(rdm_import **out, int32_t robot);
RDM_API void rdm_import_destroy(rdm_import *i); /* NULL is fine */
/* What rdm_robot_create takes; texts and arrays live as long as the handle. */
RDM_API rdm_result rdm_import_get_robot_def(const rdm_import *i, rdm_robot_def *io);
RDM_API int32_t rdm_import_note_count(const rdm_import *i); /* 0 for what is no handle */
RDM_API rdm_result rdm_import_note_at(const rdm_import *i, int32_t n,
                                      rdm_import_note *out); /* n < the count */
/* Tries the robot alone and adds notes of kind CHECK: shapes that touch at home or while one joint
 * sweeps its range, joints that do not come to rest at home or do not reach the ends of their range
 * within 2 s (weightless, own drives, no contacts). Fails as rdm_robot_create would. */
RDM_API rdm_result rdm_import_check(rdm_import *i);
/* The robot as a .robot file, text [capacity]; read back it is the same to the last bit. ARGUMENT:
 * a row names none. */
RDM_API rdm_result rdm_import_write_robot(const rdm_robot_def *def, char *text, size_t capacity,
                                          size_t *size);
/* A task out of a .task file: its scene, observation, rewards and costs as text (TOML, 1:1 with
 * rdm_task_def and what rdm_scene_* takes, and lists of terms in the place of functions).
 * Registered under the name that it says; *task is for rdm_task_at and rdm_task_destroy. A world
 * with its default options was made, reset and stepped before. The codes of
 * rdm_import_read_file. */
RDM_API rdm_result rdm_import_read_task_file(int32_t *task, const char *path);
/* The same for bytes [size]; `file` begins the texts of errors, NULL: nothing does. */
RDM_API rdm_result rdm_import_read_task(int32_t *task, const void *bytes, size_t size,
                                        const char *file);
/* Objects: an .object file (TOML, 1:1 with rdm_object_def; rows [[shape]]) as a handle for the call
 * below, or bytes [size] of one, or an object that is there. FORMAT with the line; ARGUMENT, RANGE
 * as rdm_object_create. */
RDM_API rdm_result rdm_import_read_object_file(rdm_import **out, const char *path);
RDM_API rdm_result rdm_import_read_object(rdm_import **out, const void *bytes, size_t size);
RDM_API rdm_result rdm_import_create_object(rdm_import **out, int32_t object);
/* What rdm_object_create takes; texts and arrays live as long as the handle. */
RDM_API rdm_result rdm_import_get_object_def(const rdm_import *i, rdm_object_def *io);
/* The object as an .object file, text [capacity]; read back it is the same to the last bit. */
RDM_API rdm_result rdm_import_write_object(const rdm_object_def *def, char *text, size_t capacity,
                                           size_t *size);
/* This thread's last failure in this library, one line; valid until its next failing call. */
RDM_API const char *rdm_import_error(void);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_IMPORT_H */

#if !defined(RDM_NO_DEPRECATED)
#include <redman/deprecated.h>
#endif
