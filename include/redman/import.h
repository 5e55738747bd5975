/* redman/import.h: robots, objects and tasks from files. Experimental.
 *
 * A library of its own, redman_import, beside redman.
 *
 * URDF, the kinematic subset of MJCF, and redman's own text format (.robot: TOML, 1:1 with
 * rdm_robot_def) become an rdm_robot_def; what else a file holds is listed, each element with its
 * line.
 *
 *   rdm_import *i;  rdm_robot_def d;  int32_t robot;
 *   if (rdm_import_read_file(&i, "hand.urdf", NULL)) puts(rdm_import_error());  line and element
 *   rdm_robot_def_init(&d, sizeof d);
 *   rdm_import_get_robot_def(i, &d);
 *   rdm_robot_create(&robot, &d);
 *   rdm_import_destroy(i);
 *
 * Rules of redman.h hold. The text of a failure is rdm_import_error() of the calling thread. Only
 * rdm_import_check changes an rdm_import; any number of threads may read it.
 *
 * What could change a mass, pose, axis, range or coupling is either read, or refused with the name
 * of its element; unknown elements and attributes of URDF or MJCF are refused, too. Dropped, each
 * with a note: visual elements, friction and softness of contacts, springs of joints and tendons,
 * wide limits of tendons, actuators that hold no joint (their effort is used), sensors, options of
 * a simulator, soft limits of controllers, and extensions of URDF by other programs.
 *
 * What is converted: links on fixed joints become part of the link that carries them; a mesh
 * becomes the smallest of box, capsule and sphere around its corners; a joint without limits gets
 * +-2 pi, rad or m (config.slide_range). Gains come from position actuators; without one, kp is
 * such that the drive reaches its effort 0.2 rad (20 mm) off the target, and kd damps critically
 * with the joint's inertia at home. What no such file says (palm, fingers, tips, mount, flange,
 * poses) is guessed, the same way each time, and listed. */
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
/* how a file is read; ARGUMENT for root, roles, density or slide_range with a .robot file */
typedef struct rdm_import_config {
  uint32_t struct_size;    /* bytes, set by rdm_import_config_init */
  int32_t format;          /* RDM_IMPORT_* */
  int32_t kind;            /* RDM_ROBOT_*, -1: guessed; default -1 */
  int32_t skip_meshes;     /* flag: meshes that cannot be read are dropped with a note, else
                            * refused */
  const char *name;        /* of the robot, which then has no alias; NULL: the file's */
  const char *folder;      /* folder that the names of meshes in a text start from; NULL: that of
                            * the file, or none */
  const char *packages;    /* folder that holds the folders of package://; NULL: searched above
                            * the file */
  const char *root;        /* link (body) whose subtree is read, "world" for all of an MJCF file;
                            * NULL: the whole tree, of an MJCF file the only body of its world */
  const char *palm;        /* link; NULL: guessed */
  const char *tips;        /* links or sites, "a,b,c", one for each finger; NULL: guessed */
  const char *mount;       /* link or site, or "x y z roll pitch yaw" in the root frame; NULL:
                            * guessed */
  const char *flange;      /* link or site, "none"; NULL: guessed */
  char *error;             /* [error_size] receives the text when a call that takes this config
                            * fails; NULL: not wanted */
  int32_t error_size;      /* bytes, terminator included; a longer text is cut */
  int32_t mend_inertia;    /* flag: moments that violate the triangle inequality are raised with a
                            * note, else refused */
  double density;          /* kg/m3, of the <collision> shapes of URDF links without <inertial>; 0:
                            * such links are massless. ARGUMENT when above 0 with another format,
                            * where geoms have their own */
  double slide_range;      /* m to either side, range of a sliding joint without limits; 0: 2 pi */
} rdm_import_config;
typedef struct rdm_import_note { /* frozen layout; texts live as long as the handle */
  int32_t kind;            /* RDM_NOTE_* */
  int32_t line;            /* line of the file, from 1; 0: none */
  const char *text;        /* one line, with the element and, in an included file, its name */
} rdm_import_note;
/* Fills the first `size` bytes with defaults. */
RDM_API rdm_result rdm_import_config_init(rdm_import_config *c, size_t size);
/* Reads a file; c may be NULL for the defaults. NOT_FOUND, IO; FORMAT: malformed, with its line;
 * ARGUMENT, RANGE: an impossible robot, with line and element; UNSUPPORTED: an element that would
 * change the robot and is not read. Anything but a regular file is IO and never waited for. A file
 * and all that it includes or names may take at most 4096 files, 16 MB of text, 512 MB of meshes
 * (64 MB each), 250,000 elements, 400,000 attributes and 10 million steps of work: RANGE beyond. */
RDM_API rdm_result rdm_import_read_file(rdm_import **out, const char *path,
                                        const rdm_import_config *c);
/* The same for bytes [size] of a file. Without config.folder it has neither meshes nor includes. */
RDM_API rdm_result rdm_import_read(rdm_import **out, const void *bytes, size_t size,
                                   const rdm_import_config *c);
/* Makes a handle of an existing robot, such as one of the library's own, so that it can be
 * written. */
RDM_API rdm_result rdm_import_create_robot(rdm_import **out, int32_t robot);
RDM_API void rdm_import_destroy(rdm_import *i); /* NULL is fine */
/* What rdm_robot_create takes; texts and arrays live as long as the handle. */
RDM_API rdm_result rdm_import_get_robot_def(const rdm_import *i, rdm_robot_def *io);
RDM_API int32_t rdm_import_note_count(const rdm_import *i); /* 0 for anything but a handle */
RDM_API rdm_result rdm_import_note_at(const rdm_import *i, int32_t n,
                                      rdm_import_note *out); /* n < the count */
/* Tries the robot alone and adds notes of kind CHECK: shapes that touch at home or while one joint
 * sweeps its range, joints that do not come to rest at home or do not reach the ends of their range
 * within 2 s (weightless, own drives, no contacts). Fails as rdm_robot_create would. */
RDM_API rdm_result rdm_import_check(rdm_import *i);
/* The robot as a .robot file, text [capacity]; read back it is the same to the last bit. ARGUMENT
 * where a row refers to one that does not exist, for numbers that are not finite and for names that
 * are not UTF-8. */
RDM_API rdm_result rdm_import_write_robot(const rdm_robot_def *def, char *text, size_t capacity,
                                          size_t *size);
/* Registers the task of a .task file: its scene, observation, rewards and costs as text (TOML, 1:1
 * with rdm_task_def and what rdm_scene_* takes, with lists of terms instead of functions). It gets
 * the name in the file; *task is for rdm_task_at and rdm_task_destroy. Before that, a world with
 * default options is made, reset and stepped. Errors are those of rdm_import_read_file. */
RDM_API rdm_result rdm_import_read_task_file(int32_t *task, const char *path);
/* The same for bytes [size]; texts of errors begin with `file`; NULL: with nothing. */
RDM_API rdm_result rdm_import_read_task(int32_t *task, const void *bytes, size_t size,
                                        const char *file);
/* Objects: an .object file (TOML, 1:1 with rdm_object_def; rows [[shape]]) as a handle for the call
 * below, or bytes [size] of one, or an existing object. FORMAT with the line; ARGUMENT, RANGE as
 * rdm_object_create. */
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
